//! Where bonds end on their fibres, and what they are by themselves.
use super::super::error::{FrameError, check};
use super::super::input::FrameBond;
use super::super::places::CentreLine;

/// A bond this share of its fibre's length beyond the end is at the end: arc lengths are written with few digits. That
/// of the API's check, so that what it lets in is not refused here.
const AT_END: f64 = 1e-6;

/// Normal and shear strength [mN], infinite where none is given.
pub(super) fn strengths(bond: &FrameBond) -> [f64; 2] {
    [bond.normal_strength_mn, bond.shear_strength_mn]
        .map(|strength| strength.unwrap_or(f64::INFINITY))
}

/// Bonds that hold nothing.
pub(super) fn void(bonds: &[FrameBond]) -> Vec<u32> {
    let all = 0..bonds.len() as u32;
    all.filter(|&bond| bonds[bond as usize].is_void()).collect()
}

/// One end of a bond on its fibre.
#[derive(Debug)]
pub(super) struct BondEnd {
    pub(super) fibre: u32,
    pub(super) arc_um: f64,
    pub(super) bond: u32,
    pub(super) side: usize,
}

/// Both ends of all bonds, by fibre and arc length.
pub(super) fn bond_ends(
    lines: &[CentreLine],
    bonds: &[FrameBond],
) -> Result<Vec<BondEnd>, FrameError> {
    let mut ends = Vec::with_capacity(2 * bonds.len());
    for (number, bond) in bonds.iter().enumerate() {
        bond.check(number)?;
        for side in 0..2 {
            let (fibre, at_um) = (bond.fibres[side], bond.at_um[side]);
            let Some(line) = lines.get(fibre as usize) else {
                return Err(FrameError::NoSuchFibre {
                    bond: number,
                    fibre,
                    fibres: lines.len(),
                });
            };
            check(
                || format!("place [um] of bond {number} on fibre {fibre}"),
                at_um,
                true,
                "finite",
            )?;
            let length_um = line.length_um();
            let slack = AT_END * length_um;
            if at_um < -slack || at_um > length_um + slack {
                return Err(FrameError::BeyondFibre {
                    bond: number,
                    fibre,
                    at_um,
                    length_um,
                });
            }
            ends.push(BondEnd {
                fibre,
                arc_um: at_um.clamp(0.0, length_um),
                bond: number as u32,
                side,
            });
        }
    }
    ends.sort_by(|a, b| a.fibre.cmp(&b.fibre).then(a.arc_um.total_cmp(&b.arc_um)));
    Ok(ends)
}
