//! What belongs to the paper and to its force sensor: its figures and claims, and the calibration
//! of springs, forces and behaviour, and the same for a colony of one's own.
#![forbid(unsafe_code)]

pub mod calibrate;
pub mod colony;
pub mod from_tips;
pub mod paper;
