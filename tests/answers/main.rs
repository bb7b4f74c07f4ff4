//! Answers of comparisons on scenes whose truth is known or that are hard to compute.

mod attribution;
mod finite;
mod oracle;
mod quantities;
mod tips;
mod vary;
