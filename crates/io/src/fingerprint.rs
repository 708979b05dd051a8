//! [`Fingerprint`]: whether two texts with the files that they name are the same.

use std::path::Path;

/// FNV-1a, 64 bits: guards against a changed case, not against an adversary.
pub struct Fingerprint(u64);

impl Fingerprint {
    /// Of a case's canonical text and of the contents of files, in order.
    pub fn of(canonical: &str, files: &[impl AsRef<Path>]) -> String {
        let mut hash = Self::new();
        hash.add(canonical.as_bytes());
        for file in files {
            hash.add(&content(file.as_ref()));
        }
        format!("{:016x}", hash.0)
    }

    /// Of the contents of one file.
    pub fn of_file(file: &Path) -> String {
        format!("{:016x}", Self::of_bytes(&content(file)))
    }

    /// Of bytes.
    pub fn of_bytes(bytes: &[u8]) -> u64 {
        let mut hash = Self::new();
        hash.add(bytes);
        hash.0
    }

    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        // The length first, so that two lists of files cannot run into one.
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

/// A file that vanished since it was read changes the hash, as it should.
fn content(file: &Path) -> Vec<u8> {
    std::fs::read(file).unwrap_or_default()
}
