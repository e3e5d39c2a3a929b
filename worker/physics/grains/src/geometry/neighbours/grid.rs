//! Pairs of spheres closer than the skin, by grids of cells.
//!
//! Spheres are sorted into levels by size, each level half the radius of the one before, with a
//! grid of its own whose cells are as wide as the reach of its largest spheres. A sphere looks
//! around in its own level and in the coarser ones, where 27 cells always reach far enough: a
//! scene of grains and dust costs no more per sphere than one of equal sizes.
use std::ops::RangeInclusive;

use loadframe_numerics::Team;

use crate::numbers::rows::Row;

/// Finest level: radii below 2⁻¹⁵ of the largest share it.
pub(crate) const FINEST: usize = 15;
/// Cells per sphere at most; sparser grids get wider cells.
const CELLS_PER_SPHERE: f64 = 4.0;
/// The grid covers so many standard deviations to either side. What is farther away is counted to
/// the outermost cells: still found, and strays do not blow up the grid.
const COVERED: f64 = 4.0;

/// Spheres that a thread searches for at once.
const CHUNK: usize = 1024;

/// Partners of each sphere with a higher number, ascending.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    starts: Vec<u32>,
    partners: Vec<u32>,
}

/// Spheres of one size class, sorted into cells.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    low: [f64; 3],
    inverse_width: f64,
    cells: [usize; 3],
    /// Where each cell's spheres begin in `spheres`.
    starts: Vec<u32>,
    spheres: Vec<u32>,
    /// Theirs, so that those of neighbouring cells are read one after the other.
    rows: Vec<Row>,
}

impl Candidates {
    pub(crate) fn of(&self, sphere: usize) -> &[u32] {
        &self.partners[self.starts[sphere] as usize..self.starts[sphere + 1] as usize]
    }

    /// Candidates of all spheres before this one.
    pub(crate) fn before(&self, sphere: usize) -> usize {
        self.starts[sphere] as usize
    }

    pub(crate) fn spheres(&self) -> usize {
        self.starts.len() - 1
    }
}

/// Every pair of spheres whose surfaces are closer than `skin` [m] and that `may_touch` allows, and
/// the pairs `besides` that are not, the lower sphere first.
pub(crate) fn candidates(
    team: &Team,
    spheres: &[Row],
    skin: f64,
    besides: Vec<[u32; 2]>,
    may_touch: impl Fn(usize, usize) -> bool + Sync,
) -> Candidates {
    let largest = spheres.iter().map(|sphere| sphere.0[3]).fold(0.0, f64::max);
    let level_of = |sphere: &Row| {
        let ratio = largest / sphere.0[3];
        // most are as large as that, and a logarithm takes its time
        if ratio < 2.0 {
            0
        } else {
            (ratio.log2() as usize).min(FINEST)
        }
    };
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); FINEST + 1];
    for (sphere, number) in spheres.iter().zip(0..) {
        members[level_of(sphere)].push(number);
    }
    let levels: Vec<Option<Level>> = members
        .iter()
        .enumerate()
        .map(|(level, members)| {
            let reach = 2.0 * largest / (1_u64 << level) as f64 + skin;
            (!members.is_empty()).then(|| Level::new(spheres, members, reach))
        })
        .collect();

    let work = levels.iter().enumerate().flat_map(|(own, level)| {
        let counts = level.iter().map(|level| 0..level.spheres.len());
        counts.flat_map(move |places| places.step_by(CHUNK).map(move |first| (own, first)))
    });
    let mut found = team.map(work.collect(), |(own, first)| {
        let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(4 * CHUNK);
        let Some((Some(level), coarser)) = levels[..=own].split_last() else {
            return pairs;
        };
        let end = level.spheres.len().min(first + CHUNK);
        for place in first..end {
            let (sphere, row) = (level.spheres[place], level.rows[place]);
            let mut see = |others: &[u32], rows: &[Row]| {
                for (other, other_row) in others.iter().zip(rows) {
                    if is_near(&row, other_row, skin) && may_touch(sphere as usize, *other as usize)
                    {
                        pairs.push([sphere.min(*other), sphere.max(*other)]);
                    }
                }
            };
            level.after(place, &mut see);
            for level in coarser.iter().flatten() {
                level.around(&row, &mut see);
            }
        }
        pairs
    });
    found.push(besides);
    collect(team, spheres.len(), &found)
}

/// Whether the surfaces of two spheres are no farther apart than `skin` [m].
#[inline]
pub(crate) fn is_near(a: &Row, b: &Row, skin: f64) -> bool {
    let [x, y, z, _] = std::array::from_fn(|axis| b.0[axis] - a.0[axis]);
    let reach = a.0[3] + b.0[3] + skin;
    x * x + y * y + z * z <= reach * reach
}

/// Sorts pairs by first, then second sphere.
fn collect(team: &Team, spheres: usize, found: &[Vec<[u32; 2]>]) -> Candidates {
    let mut starts = vec![0_u32; spheres + 1];
    for pair in found.iter().flatten() {
        starts[pair[0] as usize + 1] += 1;
    }
    for sphere in 0..spheres {
        starts[sphere + 1] += starts[sphere];
    }
    let mut next = starts.clone();
    let mut partners = vec![0; starts[spheres] as usize];
    for [first, second] in found.iter().flatten() {
        let place = &mut next[*first as usize];
        partners[*place as usize] = *second;
        *place += 1;
    }
    let mut rest = partners.as_mut_slice();
    let bounds = starts.windows(2).map(|ends| (ends[1] - ends[0]) as usize);
    let counts: Vec<usize> = bounds.collect();
    let work = counts.chunks(CHUNK).map(|counts| {
        let (own, others) = std::mem::take(&mut rest).split_at_mut(counts.iter().sum());
        rest = others;
        (counts, own)
    });
    team.map(
        work.collect(),
        |(counts, mut own): (&[usize], &mut [u32])| {
            for count in counts {
                let (partners, others) = own.split_at_mut(*count);
                partners.sort_unstable();
                own = others;
            }
        },
    );
    Candidates { starts, partners }
}

impl Level {
    /// A grid for `members`, whose cells are at least `reach` wide.
    pub(crate) fn new(spheres: &[Row], members: &[u32], reach: f64) -> Self {
        let coordinates = |axis: usize| members.iter().map(move |m| spheres[*m as usize].0[axis]);
        let count = members.len() as f64;
        let mut low = [0.0; 3];
        let mut extent = [0.0; 3];
        for axis in 0..3 {
            let mean = coordinates(axis).sum::<f64>() / count;
            let variance = coordinates(axis).map(|x| (x - mean).powi(2)).sum::<f64>() / count;
            let far = COVERED * variance.sqrt();
            let least = coordinates(axis)
                .fold(f64::INFINITY, f64::min)
                .max(mean - far);
            let most = coordinates(axis)
                .fold(f64::NEG_INFINITY, f64::max)
                .min(mean + far);
            low[axis] = least;
            extent[axis] = (most - least).max(0.0);
        }
        let mut width = reach;
        let cells = loop {
            let cells = extent.map(|extent| (extent / width).floor() + 1.0);
            if cells.iter().product::<f64>() <= CELLS_PER_SPHERE * count + 64.0 {
                break cells.map(|cells| cells as usize);
            }
            width *= 1.25;
        };
        let mut level = Self {
            low,
            inverse_width: 1.0 / width,
            cells,
            starts: vec![0; cells.iter().product::<usize>() + 1],
            spheres: vec![0; members.len()],
            rows: vec![Row::default(); members.len()],
        };
        let cell_of: Vec<u32> = members
            .iter()
            .map(|member| level.cell(level.place(&spheres[*member as usize])) as u32)
            .collect();
        for cell in &cell_of {
            level.starts[*cell as usize + 1] += 1;
        }
        for cell in 1..level.starts.len() {
            level.starts[cell] += level.starts[cell - 1];
        }
        let mut next = level.starts.clone();
        for (member, cell) in members.iter().zip(cell_of) {
            let place = &mut next[cell as usize];
            level.spheres[*place as usize] = *member;
            level.rows[*place as usize] = spheres[*member as usize];
            *place += 1;
        }
        level
    }

    /// Cell coordinates of a sphere's centre; the nearest ones for a centre outside.
    fn place(&self, sphere: &Row) -> [usize; 3] {
        std::array::from_fn(|axis| {
            let cell = (sphere.0[axis] - self.low[axis]) * self.inverse_width;
            // negative numbers become 0
            (cell as usize).min(self.cells[axis] - 1)
        })
    }

    fn cell(&self, place: [usize; 3]) -> usize {
        (place[2] * self.cells[1] + place[1]) * self.cells[0] + place[0]
    }

    /// Cells around one along an axis.
    fn beside(&self, cell: [usize; 3], axis: usize) -> RangeInclusive<usize> {
        cell[axis].saturating_sub(1)..=(cell[axis] + 1).min(self.cells[axis] - 1)
    }

    /// Gives `see` the spheres of all cells around `sphere`, a row of cells at a time.
    pub(crate) fn around(&self, sphere: &Row, mut see: impl FnMut(&[u32], &[Row])) {
        let cell = self.place(sphere);
        for z in self.beside(cell, 2) {
            for y in self.beside(cell, 1) {
                self.row(self.beside(cell, 0), y, z, 0, &mut see);
            }
        }
    }

    /// Of the spheres around the one in this place of the grid, those in later places: so each pair of
    /// a grid comes once.
    fn after(&self, place: usize, mut see: impl FnMut(&[u32], &[Row])) {
        let cell @ [x, y, z] = self.place(&self.rows[place]);
        let beside = self.beside(cell, 0);
        self.row(x..=*beside.end(), y, z, place + 1, &mut see);
        for y in y + 1..=*self.beside(cell, 1).end() {
            self.row(beside.clone(), y, z, 0, &mut see);
        }
        for z in z + 1..=*self.beside(cell, 2).end() {
            for y in self.beside(cell, 1) {
                self.row(beside.clone(), y, z, 0, &mut see);
            }
        }
    }

    /// Gives `see` the spheres of a row of cells, from the place `from` on.
    #[inline(always)]
    fn row(
        &self,
        x: RangeInclusive<usize>,
        y: usize,
        z: usize,
        from: usize,
        see: &mut impl FnMut(&[u32], &[Row]),
    ) {
        let first = self.starts[self.cell([*x.start(), y, z])] as usize;
        let end = self.starts[self.cell([*x.end(), y, z]) + 1] as usize;
        let places = first.max(from)..end;
        see(&self.spheres[places.clone()], &self.rows[places]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_near_pair_is_found_once(
            places in prop::collection::vec((prop::array::uniform3(-1.0..1.0_f64), 0.002..0.3_f64), 0..60),
            strays in 0..3_usize,
            skin in 0.0..0.1_f64,
        ) {
            let mut spheres: Vec<Row> = places.iter().map(|([x, y, z], r)| Row([*x, *y, *z, *r])).collect();
            for (stray, sphere) in spheres.iter_mut().take(strays).enumerate() {
                sphere.0[stray] *= 1e6;
            }
            let team = Team::new(1).expect("a team of one needs no threads");
            let found = candidates(&team, &spheres, skin, Vec::new(), |a, b| (a + b) % 7 != 0);
            for a in 0..spheres.len() {
                let expected: Vec<u32> = (a + 1..spheres.len())
                    .filter(|b| is_near(&spheres[a], &spheres[*b], skin) && (a + b) % 7 != 0)
                    .map(|b| b as u32)
                    .collect();
                prop_assert_eq!(found.of(a), expected.as_slice());
            }
        }
    }
}
