//! The sites of a body: what the boundary solver has in place of texels.

use crate::stages::cluster::Tree;

/// Nodes of a level of the texels' tree, and the tree above them.
#[derive(Clone, Debug)]
pub(crate) struct Sites {
    /// Of the atlas.
    pub texels: u32,
    /// Of the texels' tree.
    pub level: u32,
    /// Level 0 is the sites.
    pub tree: Tree,
}

impl Sites {
    pub fn new(texels: u32, level: u32) -> Self {
        Self { texels, level, tree: Tree::new(texels.div_ceil(1 << (2 * level))) }
    }

    pub fn texels_per_site(&self) -> u32 {
        1 << (2 * self.level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sites_are_nodes_of_the_texels_tree() {
        for texels in [1, 5, 4097, 186_325] {
            let tree = Tree::new(texels);
            for level in 0..2 {
                let sites = Sites::new(texels, level);
                assert_eq!(sites.tree.counts[0], tree.counts[level as usize]);
                assert!(sites.tree.counts[0] * sites.texels_per_site() >= texels);
            }
        }
    }
}
