//! Order along a space-filling curve.
use crate::numbers::Vector;

/// Bits of each coordinate on the curve.
const BITS: u32 = 20;

/// Numbers of the points in the order in which a Z-curve through their box passes them; points in
/// one cell of the curve keep the order of their numbers.
pub(crate) fn along_curve(points: &[Vector]) -> Vec<u32> {
    let low = points
        .iter()
        .fold(Vector::repeat(f64::INFINITY), |low, point| low.inf(point));
    let high = points
        .iter()
        .fold(Vector::repeat(f64::NEG_INFINITY), |high, point| {
            high.sup(point)
        });
    let extent = (high - low).max().max(f64::MIN_POSITIVE);
    let cells = f64::from((1_u32 << BITS) - 1);
    let key = |point: &Vector| {
        (0..3).fold(0, |key, axis| {
            // one scale for all axes, so that cells are cubes
            let cell = ((point[axis] - low[axis]) / extent * cells) as u64;
            key | spread(cell) << axis
        })
    };
    let mut order: Vec<(u64, u32)> = points
        .iter()
        .zip(0..)
        .map(|(point, number)| (key(point), number))
        .collect();
    order.sort_unstable();
    order.into_iter().map(|(_, number)| number).collect()
}

/// Puts two zero bits behind each of the 21 lowest bits.
fn spread(mut bits: u64) -> u64 {
    bits &= 0x001f_ffff;
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_of_a_cube_come_in_the_order_of_the_curve() {
        let corners: Vec<Vector> = (0..8)
            .rev()
            .map(|corner| {
                Vector::new(
                    f64::from(corner & 1),
                    f64::from(corner >> 1 & 1),
                    f64::from(corner >> 2),
                )
            })
            .collect();
        assert_eq!(along_curve(&corners), [7, 6, 5, 4, 3, 2, 1, 0]);
        assert_eq!(along_curve(&[Vector::zeros(); 3]), [0, 1, 2]);
        assert!(along_curve(&[]).is_empty());
    }
}
