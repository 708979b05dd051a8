//! Base64 as VTK uses it: several padded streams may be concatenated.

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Appends the padded encoding of `bytes`.
pub(super) fn encode(bytes: &[u8], out: &mut Vec<u8>) {
    out.reserve(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |at: usize| u32::from(chunk.get(at).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for at in 0..4 {
            let six = ALPHABET[(word >> (18 - 6 * at)) as usize & 63];
            out.push(if at <= chunk.len() { six } else { b'=' });
        }
    }
}

/// Decodes forward; padding ends a group of four, not the stream.
pub(super) struct Decoder<'a> {
    text: &'a [u8],
    /// Decoded bytes not yet taken.
    ready: [u8; 3],
    waiting: usize,
}

impl<'a> Decoder<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, ready: [0; 3], waiting: 0 }
    }

    /// The next `count` bytes; `None` when the text ends before, or is not base64.
    pub fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        if count > self.text.len() / 4 * 3 + 3 {
            return None;
        }
        let mut out = Vec::with_capacity(count);
        while out.len() < count {
            if self.waiting == 0 {
                self.group()?;
            }
            let part = self.waiting.min(count - out.len());
            out.extend_from_slice(&self.ready[..part]);
            self.ready.rotate_left(part);
            self.waiting -= part;
        }
        Some(out)
    }

    /// Decodes four characters.
    fn group(&mut self) -> Option<()> {
        let (mut word, mut characters, mut padding) = (0_u32, 0, 0);
        while characters < 4 {
            let (first, rest) = self.text.split_first()?;
            self.text = rest;
            let six = match first {
                b'A'..=b'Z' => first - b'A',
                b'a'..=b'z' => first - b'a' + 26,
                b'0'..=b'9' => first - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' if characters >= 2 => {
                    padding += 1;
                    0
                }
                space if space.is_ascii_whitespace() => continue,
                _ => return None,
            };
            if padding > 0 && *first != b'=' {
                return None;
            }
            word = word << 6 | u32::from(six);
            characters += 1;
        }
        let [_, a, b, c] = word.to_be_bytes();
        self.ready = [a, b, c];
        self.waiting = 3 - padding;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodes_the_vectors_of_rfc_4648_and_decodes_them_chained() {
        let vectors = [("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("fooba", "Zm9vYmE=")];
        let mut chain = Vec::new();
        for (plain, coded) in vectors {
            let mut out = Vec::new();
            encode(plain.as_bytes(), &mut out);
            assert_eq!(out, coded.as_bytes());
            chain.extend(out);
        }
        let mut decoder = Decoder::new(&chain);
        for (plain, _) in vectors {
            assert_eq!(decoder.take(plain.len()).unwrap(), plain.as_bytes());
        }
        assert!(decoder.take(1).is_none());
        assert!(Decoder::new(b"Zm*v").take(3).is_none());
        assert!(Decoder::new(b"Zm9v").take(usize::MAX).is_none());
    }
}
