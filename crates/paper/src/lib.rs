//! What belongs to the paper and to its force sensor: its figures and claims, and the calibration
//! of springs, forces and behaviour.
#![forbid(unsafe_code)]

pub mod calibrate;
pub mod from_tips;
pub mod paper;
