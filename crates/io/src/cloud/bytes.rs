//! [`Real`] and [`Bytes`]: numbers of binary clouds.

/// The numbers that NPY and PLY know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Real {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Real {
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number in these bytes; there are as many as its size.
    fn of(self, bytes: &[u8], big: bool) -> Option<f64> {
        fn array<const N: usize>(bytes: &[u8], big: bool) -> Option<[u8; N]> {
            let mut own: [u8; N] = bytes.try_into().ok()?;
            if big {
                own.reverse();
            }
            Some(own)
        }
        Some(match self {
            Self::I8 => i8::from_le_bytes(array(bytes, big)?).into(),
            Self::U8 => u8::from_le_bytes(array(bytes, big)?).into(),
            Self::I16 => i16::from_le_bytes(array(bytes, big)?).into(),
            Self::U16 => u16::from_le_bytes(array(bytes, big)?).into(),
            Self::I32 => i32::from_le_bytes(array(bytes, big)?).into(),
            Self::U32 => u32::from_le_bytes(array(bytes, big)?).into(),
            Self::I64 => i64::from_le_bytes(array(bytes, big)?) as f64,
            Self::U64 => u64::from_le_bytes(array(bytes, big)?) as f64,
            Self::F32 => f32::from_le_bytes(array(bytes, big)?).into(),
            Self::F64 => f64::from_le_bytes(array(bytes, big)?),
        })
    }
}

/// Bytes that are read from their beginning.
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    pub at: usize,
    pub big: bool,
}

impl<'a> Bytes<'a> {
    pub fn new(all: &'a [u8], at: usize, big: bool) -> Self {
        Self { all, at, big }
    }

    /// The next number; nothing where the bytes end before.
    pub fn next(&mut self, real: Real) -> Option<f64> {
        let bytes = self.all.get(self.at..self.at.checked_add(real.size())?)?;
        self.at += real.size();
        real.of(bytes, self.big)
    }
}
