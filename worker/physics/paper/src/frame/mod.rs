//! Beams and bars, held together by bonds.
