//! Files for ParaView: points and lines as VTK XML poly data (`.vtp`), and series of them (`.pvd`).
//!
//! Data is appended raw and compressed with zlib, in blocks as VTK reads them. Layout of an array:
//! number of blocks, bytes of a full block, bytes of the last one if it is not full, compressed
//! bytes of each block, all as unsigned 64-bit numbers, then the blocks.
//!
//! Source: VTK file formats, [`VtkUsersGuide2010`] section 19.3.
use std::io::{self, Write};

use flate2::{Compression, write::ZlibEncoder};

/// Bytes of an uncompressed block; what VTK itself uses.
const BLOCK: usize = 32_768;

/// Points alone, each a cell of its own.
pub(crate) struct Points<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) data: &'a [Array<'a>],
}

/// Points joined by lines, with data on both.
pub(crate) struct Lines<'a> {
    pub(crate) points: &'a [[f64; 3]],
    /// Points at the ends of each line.
    pub(crate) ends: &'a [[u32; 2]],
    pub(crate) point_data: &'a [Array<'a>],
    pub(crate) cell_data: &'a [Array<'a>],
}

/// Flat polygons, with data on points and polygons.
pub(crate) struct Polygons<'a> {
    pub(crate) points: &'a [[f64; 3]],
    /// Corners of each polygon, one after the other: every polygon has its own points.
    pub(crate) corners: &'a [usize],
    pub(crate) point_data: &'a [Array<'a>],
    pub(crate) cell_data: &'a [Array<'a>],
}

/// A named array of numbers.
pub(crate) struct Array<'a> {
    name: &'a str,
    components: usize,
    values: Values<'a>,
}

enum Values<'a> {
    Floats(&'a [f64]),
    Bytes(&'a [u8]),
    Indices(&'a [i32]),
}

/// Snapshots by time, here whatever grows during a test. Files of the same time are parts of one
/// picture.
pub(crate) struct Series {
    pub(crate) entries: Vec<(f64, String)>,
}

impl<'a> Array<'a> {
    pub(crate) fn scalars(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 1, Values::Floats(values))
    }

    /// Three values for each vector.
    pub(crate) fn vectors(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 3, Values::Floats(values))
    }

    pub(crate) fn bytes(name: &'a str, values: &'a [u8]) -> Self {
        Self::new(name, 1, Values::Bytes(values))
    }

    pub(crate) fn indices(name: &'a str, values: &'a [i32]) -> Self {
        Self::new(name, 1, Values::Indices(values))
    }

    fn new(name: &'a str, components: usize, values: Values<'a>) -> Self {
        Self {
            name,
            components,
            values,
        }
    }

    /// The array's element of the XML header, pointing to `offset` in the appended data.
    fn declare(&self, out: &mut dyn Write, offset: usize) -> io::Result<()> {
        let kind = match self.values {
            Values::Floats(_) => "Float64",
            Values::Bytes(_) => "UInt8",
            Values::Indices(_) => "Int32",
        };
        let (name, components) = (self.name, self.components);
        writeln!(
            out,
            "        <DataArray type=\"{kind}\" Name=\"{name}\" \
             NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        )
    }

    /// The array's appended data.
    fn encode(&self) -> io::Result<Vec<u8>> {
        let bytes: Vec<u8> = match self.values {
            Values::Floats(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Values::Bytes(values) => values.to_vec(),
            Values::Indices(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        let mut blocks = Vec::new();
        for block in bytes.chunks(BLOCK) {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block)?;
            blocks.push(encoder.finish()?);
        }
        let head = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let sizes = head.into_iter().chain(blocks.iter().map(Vec::len));
        let mut encoded: Vec<u8> = sizes.flat_map(|size| (size as u64).to_le_bytes()).collect();
        encoded.extend(blocks.concat());
        Ok(encoded)
    }
}

impl Points<'_> {
    /// Writes the `.vtp` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let count = self.points.len() as i32;
        let cells = Cells {
            section: "Verts",
            connectivity: (0..count).collect(),
            offsets: (1..=count).collect(),
        };
        write_poly_data(out, self.points, &cells, self.data, &[])
    }
}

impl Lines<'_> {
    /// Writes the `.vtp` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let lines = self.ends.len() as i32;
        let cells = Cells {
            section: "Lines",
            connectivity: self.ends.iter().flatten().map(|end| *end as i32).collect(),
            offsets: (1..=lines).map(|line| 2 * line).collect(),
        };
        write_poly_data(out, self.points, &cells, self.point_data, self.cell_data)
    }
}

impl Polygons<'_> {
    /// Writes the `.vtp` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut end = 0;
        let offsets = self.corners.iter().map(|corners| {
            end += *corners as i32;
            end
        });
        let cells = Cells {
            section: "Polys",
            connectivity: (0..self.points.len() as i32).collect(),
            offsets: offsets.collect(),
        };
        write_poly_data(out, self.points, &cells, self.point_data, self.cell_data)
    }
}

/// Cells by the points they join.
struct Cells {
    /// `Verts`, `Lines` or `Polys`.
    section: &'static str,
    connectivity: Vec<i32>,
    /// Where each cell ends in `connectivity`.
    offsets: Vec<i32>,
}

fn write_poly_data(
    out: &mut dyn Write,
    points: &[[f64; 3]],
    cells: &Cells,
    point_data: &[Array<'_>],
    cell_data: &[Array<'_>],
) -> io::Result<()> {
    let positions = [Array::vectors("Points", points.as_flattened())];
    let topology = [
        Array::indices("connectivity", &cells.connectivity),
        Array::indices("offsets", &cells.offsets),
    ];
    let sections: [(&str, &[Array<'_>]); 4] = [
        ("PointData", point_data),
        ("CellData", cell_data),
        ("Points", &positions),
        (cells.section, &topology),
    ];
    let count = |section: &str| {
        if cells.section == section {
            cells.offsets.len()
        } else {
            0
        }
    };
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
    )?;
    writeln!(out, "  <PolyData>")?;
    writeln!(
        out,
        "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" \
         NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">",
        points.len(),
        count("Verts"),
        count("Lines"),
        count("Polys")
    )?;
    let mut data = Vec::new();
    for (section, arrays) in sections {
        writeln!(out, "      <{section}>")?;
        for array in arrays {
            array.declare(out, data.len())?;
            data.extend(array.encode()?);
        }
        writeln!(out, "      </{section}>")?;
    }
    writeln!(out, "    </Piece>\n  </PolyData>")?;
    write!(out, "  <AppendedData encoding=\"raw\">\n_")?;
    out.write_all(&data)?;
    writeln!(out, "\n  </AppendedData>\n</VTKFile>")
}

impl Series {
    /// Writes the `.pvd` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\">")?;
        writeln!(out, "  <Collection>")?;
        let mut last: Option<(f64, u32)> = None;
        for (time, file) in &self.entries {
            let part = match last {
                Some((before, part)) if before.total_cmp(time).is_eq() => part + 1,
                _ => 0,
            };
            last = Some((*time, part));
            writeln!(
                out,
                "    <DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>"
            )?;
        }
        writeln!(out, "  </Collection>\n</VTKFile>")
    }
}
