//! STL files, binary and ASCII.
//!
//! Binary: 80 bytes of header, the number of triangles as u32, then 50 bytes each: normal and three
//! corners as f32, two bytes of attributes, all little-endian. ASCII: `facet`, `outer loop`, three
//! times `vertex x y z`, `endloop`, `endfacet`, between `solid` and `endsolid`, which may repeat.
//! Normals are not read: the order of the corners says the same. An STL file has no unit.
//!
//! Many programs write binary headers that begin with `solid`, so that the word decides nothing: a
//! file is binary when its length is what its number of triangles asks for. Own code because the
//! crate for it, stl_io 0.11, goes by the word.
use std::str::FromStr as _;

use super::Triangle;

const HEADER: usize = 80;
const PREFIX: usize = HEADER + 4;
const RECORD: usize = 50;

/// Why a file is not a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    #[error(
        "{bytes} bytes are neither an ASCII STL file, which begins with \"solid\", nor a binary one, which has 84 bytes and more"
    )]
    NotStl { bytes: usize },
    #[error(
        "a binary STL file of {triangles} triangles has {expected} bytes, this one has {bytes}"
    )]
    Length {
        triangles: u32,
        expected: usize,
        bytes: usize,
    },
    #[error("line {line}: found \"{found}\", expected {expected}")]
    Line {
        line: usize,
        found: String,
        expected: &'static str,
    },
    #[error("triangle {triangle} has a corner that is not finite")]
    NotFinite { triangle: usize },
    #[error("the file has no triangles")]
    Empty,
}

/// Reads the triangles of an STL file, in its unit.
///
/// # Errors
/// See [`StlError`]; triangles and lines count from 1.
pub fn read_stl(bytes: &[u8]) -> Result<Vec<Triangle>, StlError> {
    let promised = bytes.get(HEADER..PREFIX).map(|count| {
        let count = count
            .iter()
            .rev()
            .fold(0, |sum, byte| sum << 8 | u32::from(*byte));
        (count, PREFIX + RECORD * count as usize)
    });
    let text = std::str::from_utf8(bytes).ok().filter(|text| {
        let start = text.trim_start_matches('\u{feff}').trim_start();
        start
            .get(..5)
            .is_some_and(|word| word.eq_ignore_ascii_case("solid"))
    });
    let triangles = match (promised, text) {
        (Some((_, expected)), _) if bytes.len() == expected => read_binary(&bytes[PREFIX..]),
        (_, Some(text)) => read_ascii(text)?,
        (Some((triangles, expected)), None) => {
            let bytes = bytes.len();
            return Err(StlError::Length {
                triangles,
                expected,
                bytes,
            });
        }
        (None, None) => return Err(StlError::NotStl { bytes: bytes.len() }),
    };
    let is_finite = |corners: &Triangle| {
        corners
            .iter()
            .flat_map(|corner| corner.iter())
            .all(|value| value.is_finite())
    };
    if let Some(index) = triangles.iter().position(|corners| !is_finite(corners)) {
        return Err(StlError::NotFinite {
            triangle: index + 1,
        });
    }
    if triangles.is_empty() {
        return Err(StlError::Empty);
    }
    Ok(triangles)
}

fn read_binary(records: &[u8]) -> Vec<Triangle> {
    let (records, _) = records.as_chunks::<RECORD>();
    let corners = |record: &[u8; RECORD]| {
        let (numbers, _) = record.as_chunks::<4>();
        // three numbers of the normal, then three of each corner
        std::array::from_fn(|corner| {
            std::array::from_fn(|axis| {
                f64::from(f32::from_le_bytes(numbers[3 + 3 * corner + axis]))
            })
        })
    };
    records.iter().map(corners).collect()
}

fn read_ascii(text: &str) -> Result<Vec<Triangle>, StlError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut triangles = Vec::new();
    let mut expected = Expected::Solid;
    let mut corners = [[0.0; 3]; 3];
    let mut last_line = 0;
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else {
            continue;
        };
        last_line = index + 1;
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword);
        expected = match expected {
            Expected::Solid if is("solid") => Expected::Facet,
            Expected::Facet if is("facet") => Expected::Loop,
            Expected::Facet if is("endsolid") => Expected::Solid,
            Expected::Loop if is("outer") => Expected::Vertex(0),
            Expected::Vertex(corner @ 0..3) if is("vertex") => {
                let numbers: Vec<f64> = words.map_while(|word| f64::from_str(word).ok()).collect();
                let [x, y, z] = numbers[..] else {
                    return Err(wrong(last_line, line, "vertex and three numbers"));
                };
                corners[corner] = [x, y, z];
                Expected::Vertex(corner + 1)
            }
            Expected::Vertex(3) if is("endloop") => Expected::EndFacet,
            Expected::EndFacet if is("endfacet") => {
                triangles.push(corners);
                Expected::Facet
            }
            _ => return Err(wrong(last_line, line, expected.keyword())),
        };
    }
    match expected {
        Expected::Solid => Ok(triangles),
        _ => Err(wrong(
            last_line + 1,
            "the end of the file",
            expected.keyword(),
        )),
    }
}

fn wrong(line: usize, found: &str, expected: &'static str) -> StlError {
    let found = found.trim().chars().take(60).collect();
    StlError::Line {
        line,
        found,
        expected,
    }
}

/// What the next line of an ASCII file has to be.
#[derive(Clone, Copy)]
enum Expected {
    Solid,
    Facet,
    Loop,
    /// So many corners are known.
    Vertex(usize),
    EndFacet,
}

impl Expected {
    fn keyword(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Facet => "facet or endsolid",
            Self::Loop => "outer loop",
            Self::Vertex(3) => "endloop",
            Self::Vertex(_) => "vertex",
            Self::EndFacet => "endfacet",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ASCII: &str = "solid plate of steel\n facet normal 0 0 1\n  outer loop\n   \
        vertex 0 0 0\n   vertex 1.5 0 0\n   VERTEX 0 2e-1 0\n  endloop\n endfacet\nendsolid\n";

    fn plate() -> Vec<Triangle> {
        vec![[[0.0; 3], [1.5, 0.0, 0.0], [0.0, 0.25, 0.0]]]
    }

    fn binary(header: &str, triangles: &[Triangle]) -> Vec<u8> {
        let mut bytes = vec![b' '; HEADER];
        bytes[..header.len()].copy_from_slice(header.as_bytes());
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for corners in triangles {
            bytes.extend([0; 12]);
            for value in corners.iter().flat_map(|corner| corner.iter()) {
                bytes.extend((*value as f32).to_le_bytes());
            }
            bytes.extend([7, 7]);
        }
        bytes
    }

    #[test]
    fn ascii_is_read_in_any_case_and_spacing() {
        let mut expected = plate();
        expected[0][2][1] = 0.2;
        assert_eq!(read_stl(ASCII.as_bytes()), Ok(expected.clone()));
        let windows = ASCII.replace('\n', "\r\n\n");
        assert_eq!(
            read_stl(format!("\u{feff} {windows}").as_bytes()),
            Ok(expected.clone())
        );
        expected.push(expected[0]);
        assert_eq!(read_stl(ASCII.repeat(2).as_bytes()), Ok(expected));
    }

    #[test]
    fn binary_is_told_by_its_length_whatever_its_header_says() {
        for header in ["", "solid part", "solid facet normal 0 0 1"] {
            assert_eq!(read_stl(&binary(header, &plate())), Ok(plate()));
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let message = |bytes: &[u8]| read_stl(bytes).expect_err("it is wrong").to_string();
        let mut short = binary("part", &plate());
        short.pop();
        assert_eq!(
            message(&short),
            "a binary STL file of 1 triangles has 134 bytes, this one has 133"
        );
        assert!(message(b"PK").starts_with("2 bytes are neither"));
        assert_eq!(message(&binary("part", &[])), "the file has no triangles");
        let cases = [
            (
                "1.5 0 0",
                "1.5 0",
                "line 5: found \"vertex 1.5 0\", expected vertex and three numbers",
            ),
            (
                "1.5 0 0",
                "1.5 0 0 0",
                "line 5: found \"vertex 1.5 0 0 0\", expected vertex and three numbers",
            ),
            (
                "1.5 0 0",
                "1,5 0 0",
                "line 5: found \"vertex 1,5 0 0\", expected vertex and three numbers",
            ),
            (
                "   vertex 1.5 0 0\n",
                "",
                "line 6: found \"endloop\", expected vertex",
            ),
            (
                "  endloop\n",
                "",
                "line 7: found \"endfacet\", expected endloop",
            ),
            (
                "endsolid\n",
                "",
                "line 9: found \"the end of the file\", expected facet or endsolid",
            ),
            (
                "1.5 0 0",
                "inf 0 0",
                "triangle 1 has a corner that is not finite",
            ),
        ];
        for (from, to, expected) in cases {
            assert_eq!(message(ASCII.replace(from, to).as_bytes()), expected);
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(
            header in prop::sample::select(vec!["", "solid ", ASCII]),
            bytes in prop::collection::vec(any::<u8>(), 0..200),
            cut in 0..ASCII.len(),
        ) {
            let bytes = [&header.as_bytes()[..cut.min(header.len())], &bytes].concat();
            let _ = read_stl(&bytes);
        }
    }
}
