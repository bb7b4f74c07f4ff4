//! The attached springs: which tips are where, and how the springs respond.

mod attached;
mod attachments;
mod block;
mod blocks;
mod place;

pub(in crate::backend) use attached::{AttachedSprings, SavedSprings, TipPaths};
pub use attachments::{AttachedTip, AttachedTips, Attachment, Attachments, pulls_with};
pub use blocks::SpringBlocks;
pub use place::{Place, Travel};

#[cfg(test)]
mod tests;
