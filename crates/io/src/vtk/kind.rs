//! [`Kind`]: types of numbers by VTK's names.

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Bit,
    Signed(usize),
    Unsigned(usize),
    Real(usize),
    Text,
}

impl Kind {
    pub fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "bit" => Kind::Bit,
            "unsigned_char" | "vtktypeuint8" => Kind::Unsigned(1),
            "char" | "signed_char" | "vtktypeint8" => Kind::Signed(1),
            "unsigned_short" | "vtktypeuint16" => Kind::Unsigned(2),
            "short" | "vtktypeint16" => Kind::Signed(2),
            "unsigned_int" | "vtktypeuint32" => Kind::Unsigned(4),
            // VTK writes its own type of indices in 32 bits, whatever it has in memory
            "int" | "vtkidtype" | "vtktypeint32" => Kind::Signed(4),
            "unsigned_long" | "vtktypeuint64" => Kind::Unsigned(8),
            "long" | "vtktypeint64" => Kind::Signed(8),
            "float" | "vtktypefloat32" => Kind::Real(4),
            "double" | "vtktypefloat64" => Kind::Real(8),
            "string" | "utf8_string" => Kind::Text,
            _ => return None,
        })
    }

    /// Bytes of so many values in a binary file; of texts at least.
    pub fn bytes(self, count: u64) -> Option<u64> {
        match self {
            Kind::Bit => Some(count.div_ceil(8)),
            Kind::Signed(size) | Kind::Unsigned(size) | Kind::Real(size) => count.checked_mul(size as u64),
            Kind::Text => Some(count),
        }
    }

    pub fn is_integer(self) -> bool {
        matches!(self, Kind::Bit | Kind::Signed(_) | Kind::Unsigned(_))
    }
}
