//! The bytes of a glTF file: its container and its buffers.

use super::document::Document;
use crate::io::error::{ParseError, SourceLocation};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Returns the JSON text and the binary chunk, if there is one.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), ParseError> {
    let Some(rest) = bytes.strip_prefix(b"glTF") else {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    };
    let truncated = ParseError::Truncated {
        at: SourceLocation::Header,
    };
    let (version, rest) = split_word(rest).ok_or(truncated)?;
    if version != 2 {
        return Err(ParseError::Unsupported {
            what: "glTF of another version than 2",
        });
    }
    let mut chunks = split_word(rest)
        .ok_or(ParseError::Truncated {
            at: SourceLocation::Header,
        })?
        .1;
    let (mut json, mut binary) = (None, None);
    while let Some((kind, chunk, rest)) = split_chunk(chunks)? {
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        chunks = rest;
    }
    let json = json.ok_or(ParseError::Truncated {
        at: SourceLocation::Header,
    })?;
    Ok((json, binary))
}

fn split_word(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (word, rest) = bytes.split_first_chunk()?;
    Some((u32::from_le_bytes(*word), rest))
}

type Chunk<'a> = (u32, &'a [u8], &'a [u8]);

/// Returns the next chunk's type and bytes, and the rest.
fn split_chunk(bytes: &[u8]) -> Result<Option<Chunk<'_>>, ParseError> {
    let Some((length, rest)) = split_word(bytes) else {
        return Ok(None);
    };
    split_word(rest)
        .zip(usize::try_from(length).ok())
        .and_then(|((kind, rest), length)| {
            let (chunk, rest) = rest.split_at_checked(length)?;
            Some(Some((kind, chunk, rest)))
        })
        .ok_or(ParseError::Truncated {
            at: SourceLocation::Header,
        })
}

/// Loads the bytes of every buffer.
pub(super) fn load(
    document: &Document,
    binary: Option<&[u8]>,
    folder: Option<&Path>,
) -> Result<Vec<Vec<u8>>, ParseError> {
    let mut out = Vec::with_capacity(document.buffers.len());
    for (i, buffer) in document.buffers.iter().enumerate() {
        let at = SourceLocation::Buffer(i);
        let syntax = |expected| ParseError::Syntax { at, expected };
        let bytes = match &buffer.uri {
            None => Cow::Borrowed(
                binary
                    .filter(|_| i == 0)
                    .ok_or_else(|| syntax("a uri or a binary chunk"))?,
            ),
            Some(uri) if uri.starts_with("data:") => {
                let (_, text) = uri
                    .split_once(";base64,")
                    .ok_or_else(|| syntax("a base64 data uri"))?;
                Cow::Owned(base64(text).ok_or_else(|| syntax("base64 text"))?)
            }
            Some(uri) => {
                let folder = folder.ok_or_else(|| syntax("a buffer inside the file"))?;
                let name = file_name(uri).ok_or_else(|| {
                    syntax("the relative name of a file in the glTF's folder or below it")
                })?;
                let path = folder.join(name);
                match read_file(&path, buffer.byte_length) {
                    Ok(bytes) => Cow::Owned(bytes),
                    Err(source) => return Err(ParseError::Buffer { path, source }),
                }
            }
        };
        if bytes.len() < buffer.byte_length {
            return Err(ParseError::Truncated { at });
        }
        out.push(bytes.into_owned());
    }
    Ok(out)
}

/// Returns the file name of a URI, if it is relative without `..`, scheme or root.
fn file_name(uri: &str) -> Option<PathBuf> {
    let name = unescape(uri)?;
    // Backslashes and drive letters are rejected on all systems, because some interpret them.
    let down = !name.contains([':', '\\', '\0'])
        && Path::new(&name)
            .components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (down && !name.is_empty()).then(|| name.into())
}

/// Reads the first `length` bytes of a regular file, or all of a shorter one.
fn read_file(path: &Path, length: usize) -> io::Result<Vec<u8>> {
    // Checked before opening, because opening a pipe would block.
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "not a regular file",
        ));
    }
    let mut bytes = Vec::new();
    File::open(path)?
        .take(u64::try_from(length).unwrap_or(u64::MAX))
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Decodes base64 of RFC 4648, section 4.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0;
        for &symbol in group {
            let value = match symbol {
                b'A'..=b'Z' => symbol - b'A',
                b'a'..=b'z' => symbol - b'a' + 26,
                b'0'..=b'9' => symbol - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = (bits << 6) | u32::from(value);
        }
        let missing = 4 - group.len();
        let [_, bytes @ ..] = (bits << (6 * missing)).to_be_bytes();
        out.extend_from_slice(bytes.get(..3 - missing).filter(|_| missing < 3)?);
    }
    Some(out)
}

/// Decodes the `%xx` escapes of a URI.
fn unescape(uri: &str) -> Option<String> {
    let mut out = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        if byte == b'%' {
            let digits = std::str::from_utf8(rest.get(..2)?).ok()?;
            out.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &rest[2..];
        } else {
            out.push(byte);
        }
    }
    String::from_utf8(out).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_vectors_of_its_rfc() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64("Zm9*"), None);
        assert_eq!(base64("Zm9vY"), None);
    }

    #[test]
    fn names_lead_down_or_nowhere() {
        for (uri, name) in [
            ("mesh.bin", "mesh.bin"),
            ("a%20b.bin", "a b.bin"),
            ("parts/./mesh.bin", "parts/./mesh.bin"),
            ("..bin", "..bin"),
        ] {
            assert_eq!(file_name(uri), Some(name.into()), "{uri}");
        }
        for uri in [
            "",
            "/etc/passwd",
            "//host/mesh.bin",
            "%2Fetc/passwd",
            "../mesh.bin",
            "parts/../../mesh.bin",
            "parts/%2E%2e/mesh.bin",
            "..\\mesh.bin",
            "C:mesh.bin",
            "file:///etc/passwd",
            "mesh%00.bin",
            "mesh%2",
        ] {
            assert_eq!(file_name(uri), None, "{uri}");
        }
    }

    #[test]
    fn reads_are_limited_to_the_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.bin");
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(read_file(&path, 3).unwrap(), b"123");
        assert_eq!(read_file(&path, usize::MAX).unwrap(), b"12345");
        assert!(read_file(folder.path(), 3).is_err(), "a folder");
    }

    #[test]
    fn escapes_are_resolved() {
        assert_eq!(unescape("a%20b.bin").as_deref(), Some("a b.bin"));
        assert_eq!(unescape("a%2"), None);
    }
}
