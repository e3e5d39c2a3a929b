//! Files for ParaView: points and lines as VTK XML poly data (`.vtp`), and series of them (`.pvd`).
//!
//! Data is appended raw and compressed with zlib, in blocks as VTK reads them. Layout of an array:
//! number of blocks, bytes of a full block, bytes of the last one if it is not full, compressed
//! bytes of each block, all as unsigned 64-bit numbers, then the blocks.
//!
//! Source: VTK file formats, [`VtkUsersGuide2010`] section 19.3.
use std::io::{self, Write};

use flate2::{Compress, Compression, FlushCompress, Status};

/// Bytes of an uncompressed block; what VTK itself uses.
const BLOCK: usize = 32_768;
/// A block that shrinks to more than this part of itself is not worth the time: those that follow are
/// stored as they are. Digits of measured numbers do not shrink, indices and zeros do.
const WORTH: f64 = 0.85;
/// Of so many blocks one is tried again.
const TRIED: usize = 8;
/// Blocks between two flushes, by which whoever takes the file may say that it is not wanted: some
/// milliseconds of packing.
const BLOCKS_PER_FLUSH: usize = 16;

/// Points alone, each a cell of its own.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    pub points: &'a [[f64; 3]],
    pub data: &'a [Array<'a>],
}

/// Points joined by lines, with data on both.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    pub points: &'a [[f64; 3]],
    /// Points at the ends of each line.
    pub ends: &'a [[u32; 2]],
    pub point_data: &'a [Array<'a>],
    pub cell_data: &'a [Array<'a>],
}

/// Flat polygons, with data on points and polygons.
#[derive(Clone, Copy, Debug)]
pub struct Polygons<'a> {
    pub points: &'a [[f64; 3]],
    /// Corners of each polygon, one after the other: every polygon has its own points.
    pub corners: &'a [usize],
    pub point_data: &'a [Array<'a>],
    pub cell_data: &'a [Array<'a>],
}

/// A named array of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Array<'a> {
    name: &'a str,
    components: usize,
    values: Values<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Values<'a> {
    Floats(&'a [f64]),
    Bytes(&'a [u8]),
    Indices(&'a [i32]),
}

/// Snapshots by time, here whatever grows during a test. Files of the same time are parts of one
/// picture.
#[derive(Debug)]
pub struct Series {
    pub entries: Vec<(f64, String)>,
}

impl<'a> Array<'a> {
    pub fn scalars(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 1, Values::Floats(values))
    }

    /// Three values for each vector.
    pub fn vectors(name: &'a str, values: &'a [f64]) -> Self {
        Self::new(name, 3, Values::Floats(values))
    }

    pub fn bytes(name: &'a str, values: &'a [u8]) -> Self {
        Self::new(name, 1, Values::Bytes(values))
    }

    pub fn indices(name: &'a str, values: &'a [i32]) -> Self {
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

    /// Adds the array's appended data to `data`, as long as `out` wants it.
    fn encode(&self, data: &mut Vec<u8>, out: &mut dyn Write) -> io::Result<()> {
        let length = match self.values {
            Values::Floats(values) => size_of_val(values),
            Values::Bytes(values) => size_of_val(values),
            Values::Indices(values) => size_of_val(values),
        };
        let blocks = length.div_ceil(BLOCK);
        for number in [blocks, BLOCK, length % BLOCK] {
            data.extend((number as u64).to_le_bytes());
        }
        let sizes = data.len();
        data.resize(sizes + blocks * size_of::<u64>(), 0);
        let mut packer = Packer::new();
        let mut block = Vec::with_capacity(BLOCK);
        for number in 0..blocks {
            if number > 0 && number.is_multiple_of(BLOCKS_PER_FLUSH) {
                out.flush()?;
            }
            block.clear();
            match self.values {
                Values::Floats(values) => {
                    block.extend(part(values, number).iter().flat_map(|v| v.to_le_bytes()));
                }
                Values::Bytes(values) => block.extend(part(values, number)),
                Values::Indices(values) => {
                    block.extend(part(values, number).iter().flat_map(|v| v.to_le_bytes()));
                }
            }
            let start = data.len();
            packer.pack(number, &block, data)?;
            let size = (data.len() - start) as u64;
            let own = sizes + number * size_of::<u64>();
            data[own..][..size_of::<u64>()].copy_from_slice(&size.to_le_bytes());
        }
        Ok(())
    }
}

/// The values of a block.
fn part<T>(values: &[T], block: usize) -> &[T] {
    let count = BLOCK / size_of::<T>();
    let start = block * count;
    &values[start..values.len().min(start + count)]
}

/// Packs the blocks of an array, where that pays.
struct Packer {
    shrink: Compress,
    store: Compress,
    pays: bool,
    buffer: Vec<u8>,
}

impl Packer {
    fn new() -> Self {
        let with_header = true;
        Self {
            shrink: Compress::new(Compression::fast(), with_header),
            store: Compress::new(Compression::none(), with_header),
            pays: true,
            buffer: vec![0; 2 * BLOCK],
        }
    }

    /// Adds a block to `packed`.
    fn pack(&mut self, number: usize, block: &[u8], packed: &mut Vec<u8>) -> io::Result<()> {
        let is_tried = self.pays || number.is_multiple_of(TRIED);
        let coder = if is_tried {
            &mut self.shrink
        } else {
            &mut self.store
        };
        coder.reset();
        let start = packed.len();
        loop {
            let (read, written) = (coder.total_in(), coder.total_out());
            let rest = &block[read as usize..];
            let status = coder.compress(rest, &mut self.buffer, FlushCompress::Finish)?;
            packed.extend(&self.buffer[..(coder.total_out() - written) as usize]);
            if status == Status::StreamEnd {
                break;
            }
        }
        if is_tried {
            self.pays = (packed.len() - start) as f64 <= WORTH * block.len() as f64;
        }
        Ok(())
    }
}

impl Points<'_> {
    /// Writes the `.vtp` file.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
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
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
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
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
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
            array.encode(&mut data, out)?;
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
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
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

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::ZlibDecoder;

    use super::*;

    /// The bytes of an array, and those of each packed block.
    fn unpacked(data: &[u8]) -> (Vec<u8>, Vec<usize>) {
        let number = |index: usize| {
            let bytes = data[8 * index..][..8].try_into().expect("eight bytes");
            u64::from_le_bytes(bytes) as usize
        };
        let sizes: Vec<usize> = (0..number(0)).map(|block| number(3 + block)).collect();
        let mut bytes = Vec::new();
        let mut rest = &data[8 * (3 + sizes.len())..];
        for size in &sizes {
            let (block, others) = rest.split_at(*size);
            ZlibDecoder::new(block)
                .read_to_end(&mut bytes)
                .expect("a zlib stream");
            rest = others;
        }
        assert!(rest.is_empty());
        (bytes, sizes)
    }

    #[test]
    fn what_does_not_shrink_is_stored_and_what_does_is_found_again() {
        let of_block = BLOCK / 8;
        let noise = (0..10 * of_block).map(|i| (i as f64).sqrt().sin());
        let values: Vec<f64> = noise.chain(vec![0.0; 20 * of_block + 5]).collect();
        let mut data = Vec::new();
        let array = Array::scalars("some", &values);
        array
            .encode(&mut data, &mut io::sink())
            .expect("memory takes all");
        let (bytes, sizes) = unpacked(&data);
        let expected: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        assert!(bytes == expected);
        assert_eq!(sizes.len(), 31);
        // stored noise takes its own size and a few bytes, zeros hardly any once they are tried
        let grown = sizes[..10]
            .iter()
            .filter(|size| **size > BLOCK + BLOCK / 1000);
        assert!(grown.count() <= 2);
        let stored = sizes[10..].iter().filter(|size| **size > BLOCK / 50);
        assert!(stored.count() < TRIED);
    }

    #[test]
    fn what_is_not_wanted_any_more_is_packed_no_further() {
        /// Takes everything, and no flush after the second.
        struct Tired(usize);
        impl Write for Tired {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                Ok(bytes.len())
            }
            fn flush(&mut self) -> io::Result<()> {
                self.0 += 1;
                match self.0 {
                    1 | 2 => Ok(()),
                    _ => Err(io::Error::other("enough")),
                }
            }
        }
        let values = vec![0.0; 100 * BLOCK / 8];
        let mut data = Vec::new();
        let packed = Array::scalars("zeros", &values).encode(&mut data, &mut Tired(0));
        assert!(packed.is_err());
        // of 100 blocks those before the third flush, below their sizes
        let packed = data.len() - 8 * (3 + 100);
        let one = {
            let mut data = Vec::new();
            let first = &values[..BLOCK / 8];
            let array = Array::scalars("zeros", first);
            array.encode(&mut data, &mut io::sink()).expect("all");
            data.len() - 8 * (3 + 1)
        };
        assert_eq!(packed, 3 * BLOCKS_PER_FLUSH * one);
    }

    #[test]
    fn an_array_of_nothing_has_no_blocks() {
        let mut data = Vec::new();
        let array = Array::bytes("none", &[]);
        array
            .encode(&mut data, &mut io::sink())
            .expect("memory takes all");
        assert_eq!(data, [0, BLOCK as u64, 0].map(u64::to_le_bytes).concat());
    }
}
