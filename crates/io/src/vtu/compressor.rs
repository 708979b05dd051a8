//! What VTK compresses the blocks of arrays with.

use std::fmt;
use std::io::Read;

/// One of VTK's compressors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
    Lzma,
}

/// Bytes of a block of LZ4 become at most so many each.
const LZ4_RATIO: u64 = 255;
/// KiB that a stream of LZMA may ask for; the highest level of its encoder takes 64 MiB.
const LZMA_MEMORY: u32 = 128 << 10;

impl Compressor {
    /// By the name of VTK's class.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "vtkZLibDataCompressor" => Compressor::Zlib,
            "vtkLZ4DataCompressor" => Compressor::Lz4,
            "vtkLZMADataCompressor" => Compressor::Lzma,
            _ => return None,
        })
    }

    /// Appends a block of `unpacked` bytes, no more than `limit` of them; whether it has them.
    pub fn unpack(self, packed: &[u8], unpacked: u64, limit: u64, bytes: &mut Vec<u8>) -> bool {
        let (before, wanted) = (bytes.len(), unpacked.min(limit));
        let done = match self {
            Compressor::Zlib => flate2::read::ZlibDecoder::new(packed).take(wanted).read_to_end(bytes).is_ok(),
            Compressor::Lzma => {
                let reader = lzma_rust2::XzReader::new_mem_limit(packed, false, LZMA_MEMORY);
                reader.take(wanted).read_to_end(bytes).is_ok()
            }
            // it has no beginning that could be unpacked alone: a block beyond the limit is too long for its array
            Compressor::Lz4 => {
                let room = LZ4_RATIO.saturating_mul(packed.len() as u64 + 1);
                let size = usize::try_from(unpacked).ok().filter(|_| unpacked == wanted && unpacked <= room);
                let block = size.and_then(|size| lz4_flex::block::decompress(packed, size).ok());
                bytes.extend(block.iter().flatten());
                block.is_some()
            }
        };
        done && (bytes.len() - before) as u64 == wanted
    }
}

impl fmt::Display for Compressor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Compressor::Zlib => "zlib",
            Compressor::Lz4 => "LZ4",
            Compressor::Lzma => "LZMA",
        })
    }
}
