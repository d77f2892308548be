//! Compressed files: gzip, zstd and LZ4.

use flate2::bufread::GzDecoder;
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest log that is read [bytes]. A log is in memory as a whole.
pub(super) const LARGEST: u64 = 8 << 30;

/// Formats of frames. A compressed file is a sequence of frames.
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

    /// Decompresses the frame at the beginning of `rest`, to at most one byte more than `most`.
    fn frame(self, rest: &mut &[u8], most: u64) -> Result<Vec<u8>, String> {
        let whole = *rest;
        match self {
            Self::Gzip => read(GzDecoder::new(rest), most),
            Self::Zstd => read(StreamingDecoder::new(rest).map_err(|error| error.to_string())?, most),
            Self::Lz4 => {
                let content = read(FrameDecoder::new(&mut *rest), most)?;
                // The decoder takes the end of the bytes as the end of the frame. A checksum of the content is at the end.
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

const CUT: &str = "it ends within a frame";

/// The content of compressed bytes. Other bytes are returned unchanged.
///
/// # Errors
/// A message if frames cannot be decompressed, or if the content has more than `most` bytes.
pub(super) fn unpacked(bytes: &[u8], most: u64) -> Result<Cow<'_, [u8]>, String> {
    let Some((_, name)) = Format::of(bytes) else { return Ok(Cow::Borrowed(bytes)) };
    let (mut rest, mut content) = (bytes, Vec::new());
    while !rest.is_empty() {
        let frame = Format::of(rest).ok_or_else(|| "other bytes are behind it".to_owned());
        let frame = frame.and_then(|(format, _)| format.frame(&mut rest, most - content.len() as u64));
        content.extend(frame.map_err(|error| {
            format!("it begins as a {name} file and cannot be unpacked ({error}): pack it again")
        })?);
        if content.len() as u64 > most {
            return Err(format!("it holds more than a log may have ({most} bytes): split it"));
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
            assert!(unpacked(&both, 20_000).unwrap_err().contains("more than a log may have (20000 bytes)"));
            for cut in [1, 4, 8, two.len() / 2, two.len() - 2] {
                assert!(unpacked(&both[..both.len() - cut], LARGEST).is_err(), "{cut} of {}", both.len());
            }
            let behind = [one.as_slice(), b"t,q\n"].concat();
            assert!(unpacked(&behind, LARGEST).is_err());
        }
    }
}
