//! What bytes are that are no plain text.

/// Beginnings of files, and what such a file does not do for those who read text.
const SIGNATURES: [(&[u8], &str); 8] = [
    (b"\x1f\x8b", "is compressed by gzip; give what is within it"),
    (
        b"\x28\xb5\x2f\xfd",
        "is compressed by zstd; give what is within it",
    ),
    (
        b"PK\x03\x04",
        "is a ZIP archive, or a workbook (.xlsx, .ods): save the sheet as CSV",
    ),
    (
        b"\xd0\xcf\x11\xe0",
        "is an old Excel workbook (.xls): save the sheet as CSV",
    ),
    (b"%PDF", "is a PDF"),
    (
        b"\xef\xbb\xbf",
        "begins with the byte-order mark of UTF-8; leave that out",
    ),
    (
        b"\xff\xfe",
        "begins with the byte-order mark of UTF-16; save it as UTF-8",
    ),
    (
        b"\xfe\xff",
        "begins with the byte-order mark of UTF-16; save it as UTF-8",
    ),
];

/// What is wrong with bytes that should be plain text; `None` where their beginning is not known.
pub(crate) fn of(bytes: &[u8]) -> Option<&'static str> {
    let known = SIGNATURES.iter();
    let mut found = known.filter(|(mark, _)| bytes.starts_with(mark));
    found.next().map(|(_, what)| *what)
}
