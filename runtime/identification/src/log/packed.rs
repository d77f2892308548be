//! Packed bytes: gzip, zstd and LZ4.

use flate2::read::MultiGzDecoder;
use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;

/// Largest log that is read, in bytes: it is in memory as a whole.
pub(super) const LARGEST: u64 = 8 << 30;

/// The content of bytes that begin as a packed file does; other bytes as they are.
pub(super) fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    let (format, content) = match bytes {
        [0x1f, 0x8b, ..] => ("gzip", read(MultiGzDecoder::new(bytes))),
        [0x28, 0xb5, 0x2f, 0xfd, ..] => {
            let decoder = StreamingDecoder::new(bytes).map_err(|error| error.to_string());
            ("zstd", decoder.and_then(read))
        }
        [0x04, 0x22, 0x4d, 0x18, ..] => ("LZ4", read(FrameDecoder::new(bytes))),
        _ => return Ok(Cow::Borrowed(bytes)),
    };
    let content = content.map_err(|error| {
        format!("it begins as a {format} file and cannot be unpacked ({error}): pack it again")
    })?;
    if content.len() as u64 > LARGEST {
        return Err(format!("it holds more than a log may have ({LARGEST} bytes): split it"));
    }
    Ok(Cow::Owned(content))
}

fn read(decoder: impl Read) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    decoder.take(LARGEST + 1).read_to_end(&mut content).map_err(|error| error.to_string())?;
    Ok(content)
}
