//! Interpolation between the nodes of a row of cells and the corners of these.
//!
//! Within a cell a displacement is a + s b + t c + s t d with the node's coordinates s, t, so the four
//! numbers of each cell are laid out once along x and then serve every row of nodes there. Nodes of no
//! row are rows of one.
use crate::network::field::Real;

/// Nodes of a row worked on at once.
pub(super) const BLOCK: usize = 256;

/// Rows of nodes, at most [`BLOCK`] long, whose nodes lie in the same cells one by one.
#[derive(Clone, Debug)]
pub(super) struct Band {
    /// Place of each row's first node.
    pub(super) rows: Vec<u32>,
    pub(super) count: usize,
    /// First corner of the cell of the first node.
    pub(super) corner: u32,
    /// Nodes in that cell, in the next along x, and so on.
    pub(super) runs: Vec<u32>,
}

impl Band {
    /// Adds to `sums`, from corner number `first` on, what the nodes' `forces` are at the corners,
    /// `above` numbers from row to row.
    #[inline(always)]
    pub(super) fn restrict<T: Real>(
        &self,
        at: &[Vec<f32>; 2],
        forces: &[T],
        first: usize,
        sums: &mut [f32],
        above: usize,
        parts: &mut [[f32; BLOCK]; 4],
    ) {
        for part in parts.iter_mut() {
            part[..self.count].fill(0.0);
        }
        for row in &self.rows {
            let places = *row as usize..*row as usize + self.count;
            let [s, t] = at.each_ref().map(
                #[inline(always)]
                |at| &at[places.clone()],
            );
            let forces = &forces[places.clone()];
            let [a, b, c, d] = parts.each_mut().map(
                #[inline(always)]
                |part| &mut part[..self.count],
            );
            for node in 0..self.count {
                let force = forces[node].narrow();
                let with_t = force * t[node];
                a[node] += force;
                b[node] = force.mul_add(s[node], b[node]);
                c[node] += with_t;
                d[node] = with_t.mul_add(s[node], d[node]);
            }
        }
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let [a, b, c, d] = parts.each_ref().map(
                #[inline(always)]
                |part| part[nodes.clone()].iter().sum::<f32>(),
            );
            let corner = self.corner as usize + cell - first;
            sums[corner] += a - b - c + d;
            sums[corner + 1] += b - d;
            sums[corner + above] += c - d;
            sums[corner + above + 1] += d;
        }
    }

    /// Adds the displacements interpolated from the `corners`, `above` numbers from row to row, to
    /// those `moved` from place `first` on.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are slices of what nobody else needs as one"
    )]
    pub(super) fn prolong<T: Real>(
        &self,
        at: &[Vec<f32>; 2],
        corners: &[f32],
        above: usize,
        shares: &[f32],
        first: usize,
        moved: &mut [T],
        parts: &mut [[f32; BLOCK]; 4],
    ) {
        let mut nodes = 0..0;
        for (cell, run) in self.runs.iter().enumerate() {
            nodes = nodes.end..nodes.end + *run as usize;
            let corner = self.corner as usize + cell;
            let (left, right) = (corners[corner], corners[corner + 1]);
            let (above_left, above_right) = (corners[corner + above], corners[corner + above + 1]);
            let (b, c) = (right - left, above_left - left);
            let of_cell = [left, b, c, above_right - above_left - b];
            for (part, value) in parts.iter_mut().zip(of_cell) {
                part[nodes.clone()].fill(value);
            }
        }
        let [a, b, c, d] = parts.each_ref().map(
            #[inline(always)]
            |part| &part[..self.count],
        );
        for row in &self.rows {
            let places = *row as usize..*row as usize + self.count;
            let [s, t] = at.each_ref().map(
                #[inline(always)]
                |at| &at[places.clone()],
            );
            let shares = &shares[places.clone()];
            let moved = &mut moved[places.start - first..][..self.count];
            for node in 0..self.count {
                let at_bottom = s[node].mul_add(b[node], a[node]);
                let upwards = s[node].mul_add(d[node], c[node]);
                let value = upwards.mul_add(t[node], at_bottom);
                moved[node] += T::widen(shares[node] * value);
            }
        }
    }
}
