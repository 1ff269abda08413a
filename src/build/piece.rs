//! What the voxels of a part of the top grid consist of.

use super::options::BuildError;
use crate::arena::{Arena, BoxGroup, Brick, Form, Reference, Voxel, VoxelWord};

/// The same arrays as in [`Arena`], without the words of the top grid's voxels.
///
/// Pieces are made in parallel; indices count from the start of the piece.
#[derive(Default)]
pub(super) struct Piece {
    /// The words of the top grid's voxels.
    pub(super) top: Vec<VoxelWord>,
    pub(super) words: Vec<VoxelWord>,
    pub(super) references: Vec<Reference>,
    pub(super) bricks: Vec<Brick>,
    pub(super) groups: Vec<BoxGroup>,
}

impl Piece {
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.top)
            + size_of_val(&*self.words)
            + size_of_val(&*self.references)
            + size_of_val(&*self.bricks)
            + size_of_val(&*self.groups)
    }
}

/// Appends pieces to an arena, whose words begin with those of the top grid.
pub(super) fn join(arena: &mut Arena, pieces: Vec<Piece>) -> Result<(), BuildError> {
    let sum = |len: fn(&Piece) -> usize| pieces.iter().map(len).sum::<usize>();
    arena.words.reserve_exact(sum(|p| p.top.len() + p.words.len()));
    arena.references.reserve_exact(sum(|p| p.references.len()));
    arena.bricks.reserve_exact(sum(|p| p.bricks.len()));
    arena.groups.reserve_exact(sum(|p| p.groups.len()));
    let mut words = sum(|p| p.top.len());
    let mut moves = Vec::with_capacity(pieces.len());
    let (mut references, mut bricks, mut groups) = (0, 0, 0);
    for piece in &pieces {
        let (node, leaf) = match arena.form {
            Form::Lists { .. } => (words, references),
            Form::Bricks => (bricks, groups),
        };
        moves.push(Move { node, leaf, words });
        words += piece.words.len();
        references += piece.references.len();
        bricks += piece.bricks.len();
        groups += piece.groups.len();
    }
    if u32::try_from(words).is_err() {
        return Err(BuildError::TooLarge { what: "voxels" });
    }
    for (piece, by) in pieces.iter().zip(&moves) {
        arena.words.extend(by.words_of(&piece.top)?);
    }
    for (piece, by) in pieces.into_iter().zip(&moves) {
        arena.words.extend(by.words_of(&piece.words)?);
        arena.references.extend(piece.references);
        arena.bricks.extend(piece.bricks.iter().map(|b| Brick { first: b.first + by.words as u32, ..*b }));
        arena.groups.extend(piece.groups);
    }
    Ok(())
}

/// By how much the indices of a piece change.
struct Move {
    node: usize,
    leaf: usize,
    words: usize,
}

impl Move {
    fn words_of(&self, words: &[VoxelWord]) -> Result<Vec<VoxelWord>, BuildError> {
        words.iter().map(|&word| self.word(word)).collect()
    }

    fn word(&self, word: VoxelWord) -> Result<VoxelWord, BuildError> {
        match word.get() {
            Voxel::Empty => Ok(word),
            Voxel::Leaf(i) => {
                VoxelWord::leaf(i as usize + self.leaf).ok_or(BuildError::TooLarge { what: "references" })
            }
            Voxel::Node(i) => {
                VoxelWord::node(i as usize + self.node).ok_or(BuildError::TooLarge { what: "voxels" })
            }
        }
    }
}
