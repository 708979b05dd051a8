//! [`Palette`]: 256 colours for the pixels of a film, by median cut (P. Heckbert, 1982).

/// Bits of a channel that count.
const BITS: u32 = 5;
const CODES: usize = 1 << (3 * BITS);
/// Colours of a GIF.
const COLOURS: usize = 256;

/// A colour in five bits for each channel.
pub(super) fn code(colour: [u8; 3]) -> u16 {
    colour.into_iter().fold(0, |code, byte| code << BITS | u16::from(byte >> (8 - BITS)))
}

/// The colour of a code, white as white.
fn colour(code: usize) -> [f64; 3] {
    let most = (1 << BITS) - 1;
    [2, 1, 0].map(|channel| (code >> (channel * BITS) & most) as f64 * 255.0 / most as f64)
}

/// Colours, and which of them stands for every code.
pub(super) struct Palette {
    colours: Vec<[u8; 3]>,
    indices: Vec<u8>,
}

impl Palette {
    /// Boxes of colours are cut at their median along their longest side, the one with most spread first.
    pub fn of(codes: impl Iterator<Item = u16>) -> Self {
        let mut counts = vec![0_u64; CODES];
        codes.for_each(|code| counts[usize::from(code)] += 1);
        let seen: Vec<usize> = (0..CODES).filter(|code| counts[*code] > 0).collect();
        let mut boxes = vec![Cluster::of(seen, &counts)];
        while boxes.len() < COLOURS {
            let widest = (0..boxes.len()).filter(|k| boxes[*k].codes.len() > 1);
            let Some(k) = widest.max_by(|a, b| boxes[*a].spread.total_cmp(&boxes[*b].spread)) else { break };
            let [low, high] = boxes[k].cut(&counts);
            boxes[k] = low;
            boxes.push(high);
        }
        let mut indices = vec![0; CODES];
        for (index, own) in boxes.iter().enumerate() {
            own.codes.iter().for_each(|code| indices[*code] = index as u8);
        }
        Self { colours: boxes.iter().map(|own| own.mean.map(|x| x.round() as u8)).collect(), indices }
    }

    /// Red, green, blue of all.
    pub fn bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    pub fn index(&self, code: u16) -> u8 {
        self.indices[usize::from(code)]
    }
}

/// Codes near each other.
struct Cluster {
    codes: Vec<usize>,
    mean: [f64; 3],
    /// The channel along which they spread most.
    channel: usize,
    /// The square deviation along it, summed over pixels.
    spread: f64,
}

impl Cluster {
    fn of(codes: Vec<usize>, counts: &[u64]) -> Self {
        let weight = |code: &usize| counts[*code] as f64;
        let total: f64 = codes.iter().map(weight).sum::<f64>().max(1.0);
        let mean = [0, 1, 2].map(|c| codes.iter().map(|code| weight(code) * colour(*code)[c]).sum::<f64>() / total);
        let spreads: [f64; 3] = [0, 1, 2]
            .map(|c| codes.iter().map(|code| weight(code) * (colour(*code)[c] - mean[c]).powi(2)).sum::<f64>());
        let channel = (0..3).max_by(|a, b| spreads[*a].total_cmp(&spreads[*b])).unwrap_or(0);
        Self { codes, mean, channel, spread: spreads[channel] }
    }

    /// Both halves; each has a code at least.
    fn cut(&self, counts: &[u64]) -> [Self; 2] {
        let mut codes = self.codes.clone();
        codes.sort_by(|a, b| colour(*a)[self.channel].total_cmp(&colour(*b)[self.channel]).then(a.cmp(b)));
        let at = codes.partition_point(|code| colour(*code)[self.channel] <= self.mean[self.channel]);
        let high = codes.split_off(at.clamp(1, codes.len() - 1));
        [Self::of(codes, counts), Self::of(high, counts)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_are_kept_and_many_are_near() {
        let few: Vec<u16> = [[255, 255, 255], [0, 0, 0], [206, 66, 58]].map(code).to_vec();
        let palette = Palette::of(few.iter().copied());
        assert_eq!(palette.colours[usize::from(palette.index(few[0]))], [255; 3]);
        assert_eq!(palette.colours[usize::from(palette.index(few[1]))], [0; 3]);
        let all = Palette::of((0..CODES as u16).flat_map(|code| [code, code]));
        assert_eq!(all.colours.len(), COLOURS);
        let off = |code: u16| {
            let own = all.colours[usize::from(all.index(code))].map(f64::from);
            let wanted = colour(usize::from(code));
            (0..3).map(|k| (own[k] - wanted[k]).abs()).fold(0.0, f64::max)
        };
        assert!((0..CODES as u16).map(off).fold(0.0, f64::max) < 40.0);
    }
}
