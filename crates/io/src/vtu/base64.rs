//! Base64 as VTK uses it: several padded streams may be concatenated, and blanks stand anywhere.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::general_purpose::{GeneralPurpose, PAD};

/// Bits behind the last byte mean nothing.
const ENGINE: GeneralPurpose = GeneralPurpose::new(&STANDARD, PAD.with_decode_allow_trailing_bits(true));

/// The padded encoding of `bytes`.
pub(super) fn encode(bytes: &[u8]) -> String {
    ENGINE.encode(bytes)
}

/// Decodes forward; padding ends a group of four, not the stream.
pub(super) struct Decoder<'a> {
    text: &'a [u8],
    /// Decoded bytes not yet taken.
    ready: Vec<u8>,
}

impl<'a> Decoder<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, ready: Vec::new() }
    }

    /// The next `count` bytes; `None` when the text ends before, or is not base64.
    pub fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        if count > self.text.len() / 4 * 3 + 3 {
            return None;
        }
        let mut out = std::mem::take(&mut self.ready);
        while out.len() < count {
            let wanted = (count - out.len()).div_ceil(3) * 4;
            // at once up to a blank or to padding
            let ends = |byte: &u8| *byte == b'=' || byte.is_ascii_whitespace();
            let plain = self.text.iter().take(wanted).position(ends).unwrap_or(wanted.min(self.text.len()));
            let (run, rest) = self.text.split_at(plain / 4 * 4);
            if run.is_empty() {
                ENGINE.decode_vec(self.group()?, &mut out).ok()?;
            } else {
                ENGINE.decode_vec(run, &mut out).ok()?;
                self.text = rest;
            }
        }
        self.ready = out.split_off(count);
        Some(out)
    }

    /// The next four characters that are no blanks.
    fn group(&mut self) -> Option<[u8; 4]> {
        let mut group = [0; 4];
        for place in &mut group {
            self.text = self.text.trim_ascii_start();
            let (first, rest) = self.text.split_first()?;
            (*place, self.text) = (*first, rest);
        }
        Some(group)
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
            assert_eq!(encode(plain.as_bytes()), coded);
            chain.extend(coded.bytes());
        }
        let mut decoder = Decoder::new(&chain);
        for (plain, _) in vectors {
            assert_eq!(decoder.take(plain.len()).unwrap(), plain.as_bytes());
        }
        assert!(decoder.take(1).is_none());
        assert!(Decoder::new(b"Zm*v").take(3).is_none());
        assert_eq!(Decoder::new(b" Zm9v\n Ym\tFyZg= =").take(7).unwrap(), b"foobarf");
        assert!(Decoder::new(b"Zm9v").take(usize::MAX).is_none());
    }
}
