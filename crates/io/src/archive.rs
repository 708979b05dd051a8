//! ZIP archives: a few files, compressed, the same bytes for the same content.

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};
use std::io::{self, Write};

/// The version of the format that a reader needs: 2.0, for deflated files.
const VERSION: u16 = 20;
/// Bit 11 of the flags: names are UTF-8.
const FLAGS: u16 = 0x0800;
const DEFLATED: u16 = 8;
/// 1 January 1980, midnight: archives know no clock.
const DATE: u16 = 0x0021;

/// An archive in the making. Source: PKWARE, APPNOTE.TXT 6.3.10, sections 4.3.7, 4.3.12, 4.3.16.
#[derive(Default)]
pub(crate) struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    files: u16,
}

impl Archive {
    /// Adds a file.
    ///
    /// # Errors
    /// Those of the content; more than 4 GiB, which the format does not hold.
    pub fn add(&mut self, name: &str, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let mut encoder =
            Summed { to: DeflateEncoder::new(Vec::new(), Compression::default()), crc: Crc::new(), size: 0 };
        content(&mut encoder)?;
        let (crc, size) = (encoder.crc.sum(), encoder.size);
        let compressed = encoder.to.finish()?;
        let start = word(self.bytes.len() as u64)?;
        let mut facts = Vec::new();
        for half in [VERSION, FLAGS, DEFLATED, 0, DATE] {
            facts.extend(half.to_le_bytes());
        }
        for number in [crc, word(compressed.len() as u64)?, word(size)?] {
            facts.extend(number.to_le_bytes());
        }
        facts.extend((name.len() as u16).to_le_bytes());
        facts.extend([0; 2]);
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&facts);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(&compressed);
        self.directory.extend(b"PK\x01\x02");
        self.directory.extend(VERSION.to_le_bytes());
        self.directory.extend(&facts);
        // no comment, the first disk, no attributes
        self.directory.extend([0; 10]);
        self.directory.extend(start.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.files += 1;
        Ok(())
    }

    /// Its bytes.
    ///
    /// # Errors
    /// More than 4 GiB.
    pub fn finish(mut self) -> io::Result<Vec<u8>> {
        let [start, size] = [word(self.bytes.len() as u64)?, word(self.directory.len() as u64)?];
        self.bytes.extend(&self.directory);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        self.bytes.extend([self.files.to_le_bytes(); 2].concat());
        self.bytes.extend([size, start].map(u32::to_le_bytes).concat());
        self.bytes.extend([0; 2]);
        Ok(self.bytes)
    }
}

fn word(number: u64) -> io::Result<u32> {
    u32::try_from(number).map_err(|_| {
        io::Error::other("it would hold more than 4 GiB, which ZIP archives of this form do not: coarsen the mesh")
    })
}

/// Counts and sums what passes.
struct Summed {
    to: DeflateEncoder<Vec<u8>>,
    crc: Crc,
    size: u64,
}

impl Write for Summed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.to.write(bytes)?;
        self.crc.update(&bytes[..count]);
        self.size += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}
