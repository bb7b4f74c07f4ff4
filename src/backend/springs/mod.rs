//! The attached springs: who holds which tip where, and what the springs answer.

mod attachments;
mod block;
mod blocks;
mod place;

pub use attachments::{AttachedTip, AttachedTips, Attachment, Attachments, pulls_with};
pub(in crate::backend) use blocks::Accepted;
pub use blocks::SpringBlocks;
pub use place::Place;
