//! Decompression of files: gzip, zstd and LZ4.

use flate2::bufread::GzDecoder;
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest size of a log in bytes. The whole log is kept in memory.
pub(super) const LARGEST: u64 = 8 << 30;

/// Formats of the frames of a compressed file. Such a file is a sequence of frames.
#[derive(Clone, Copy)]
enum Format {
    Gzip,
    Zstd,
    Lz4,
    /// User data between frames of zstd and LZ4.
    Skipped,
}

impl Format {
    fn of(bytes: &[u8]) -> Option<(Self, &'static str)> {
        match bytes {
            [0x1f, 0x8b, ..] => Some((Self::Gzip, "gzip")),
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Some((Self::Zstd, "zstd")),
            [0x04, 0x22, 0x4d, 0x18, ..] => Some((Self::Lz4, "LZ4")),
            [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..] => Some((Self::Skipped, "zstd or LZ4")),
            _ => None,
        }
    }

    /// Decompresses the frame at the beginning of `rest`, up to `most` + 1 bytes.
    fn frame(self, rest: &mut &[u8], most: u64) -> Result<Vec<u8>, String> {
        let whole = *rest;
        match self {
            Self::Gzip => read(GzDecoder::new(rest), most),
            Self::Zstd => read(StreamingDecoder::new(rest).map_err(|error| error.to_string())?, most),
            Self::Lz4 => {
                let content = read(FrameDecoder::new(&mut *rest), most)?;
                // If the bytes end too early, the decoder does not report an error. The checksum of the content comes last.
                let taken = &whole[..whole.len() - rest.len()];
                let checksum = if taken.get(4).is_some_and(|flags| flags & 4 != 0) { 4 } else { 0 };
                let is_whole = taken[..taken.len() - checksum].ends_with(&[0; 4]);
                if is_whole || content.len() as u64 > most { Ok(content) } else { Err(CUT.to_owned()) }
            }
            Self::Skipped => {
                let length = whole.get(4..8).and_then(|bytes| <[u8; 4]>::try_from(bytes).ok());
                let length = length.map_or(usize::MAX, |bytes| u32::from_le_bytes(bytes) as usize);
                *rest = whole.get(8..).and_then(|rest| rest.get(length..)).ok_or(CUT)?;
                Ok(Vec::new())
            }
        }
    }
}

const CUT: &str = "the file ends within compressed data";

/// Returns the content of compressed bytes. Other bytes are returned unchanged.
///
/// # Errors
/// A message if a frame cannot be decompressed, or if the content has more than `most` bytes
pub(super) fn unpacked(bytes: &[u8], most: u64) -> Result<Cow<'_, [u8]>, String> {
    let Some((_, name)) = Format::of(bytes) else { return Ok(Cow::Borrowed(bytes)) };
    let (mut rest, mut content) = (bytes, Vec::new());
    while !rest.is_empty() {
        let frame =
            Format::of(rest).ok_or_else(|| "there are other bytes after the compressed data".to_owned());
        let frame = frame.and_then(|(format, _)| format.frame(&mut rest, most - content.len() as u64));
        content.extend(frame.map_err(|error| {
            format!(
                "the file begins as a {name} file, but cannot be decompressed: {error}. Compress it again"
            )
        })?);
        if content.len() as u64 > most {
            return Err(format!(
                "the content is larger than the largest size of a log, {most} bytes. Split the log"
            ));
        }
    }
    Ok(Cow::Owned(content))
}

fn read(decoder: impl Read, most: u64) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    decoder.take(most + 1).read_to_end(&mut content).map_err(|error| error.to_string())?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use lz4_flex::frame::FrameEncoder;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    use std::io::Write;

    fn packings(text: &[u8]) -> [Vec<u8>; 3] {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
        gzip.write_all(text).unwrap();
        let mut lz4 = FrameEncoder::new(Vec::new());
        lz4.write_all(text).unwrap();
        let zstd = compress_to_vec(text, CompressionLevel::Fastest);
        [gzip.finish().unwrap(), zstd, lz4.finish().unwrap()]
    }

    #[test]
    fn files_of_several_frames_are_read_to_their_ends() {
        let (first, second) = ("t,q\n0,1\n".repeat(2000), "1,2\n".repeat(3000));
        for (one, two) in packings(first.as_bytes()).iter().zip(packings(second.as_bytes())) {
            let skipped = if one[0] == 0x1f { Vec::new() } else { b"\x52\x2a\x4d\x18\x03\0\0\0abc".to_vec() };
            let both = [one.as_slice(), &skipped, &two].concat();
            assert_eq!(*unpacked(&both, LARGEST).unwrap(), *[first.as_bytes(), second.as_bytes()].concat());
            assert!(unpacked(&both, 20_000).unwrap_err().contains("the largest size of a log, 20000 bytes"));
            for cut in [1, 4, 8, two.len() / 2, two.len() - 2] {
                assert!(unpacked(&both[..both.len() - cut], LARGEST).is_err(), "{cut} of {}", both.len());
            }
            let behind = [one.as_slice(), b"t,q\n"].concat();
            assert!(unpacked(&behind, LARGEST).is_err());
        }
    }
}
