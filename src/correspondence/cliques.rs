//! Largest cliques of a small graph: sets of pairs that all agree with each other.
//!
//! Question     which correspondences can be true together, when each two of them can be tested for agreement
//! Input        a graph: vertices are correspondences, edges join those that agree
//! Output       all cliques of the largest size, each sorted, in lexicographic order
//! Method       branch and bound; the bound is a greedy colouring, since a clique has at most one vertex of each colour.
//!              Vertices stand in words of 64 bits. Order is fixed, so the answer is the same on every machine
//! Assumptions  some hundreds of vertices; a budget of search nodes ends a search that would take too long
//! Fails when   the budget is spent: `complete` is false, and the cliques are the largest found so far
//! Source       Tomita and Seki 2003

/// An undirected graph on vertices `0..n`.
#[derive(Clone, Debug)]
pub struct Graph {
    neighbours: Vec<Vec<u64>>,
}

/// The largest cliques found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cliques {
    pub cliques: Vec<Vec<usize>>,
    /// Whether the whole graph was searched.
    pub complete: bool,
}

impl Graph {
    pub fn new(vertices: usize) -> Graph {
        Graph { neighbours: vec![vec![0; vertices.div_ceil(64)]; vertices] }
    }

    /// Joins two vertices; a vertex is not its own neighbour.
    pub fn join(&mut self, a: usize, b: usize) {
        if a != b && a < self.neighbours.len() && b < self.neighbours.len() {
            self.neighbours[a][b / 64] |= 1 << (b % 64);
            self.neighbours[b][a / 64] |= 1 << (a % 64);
        }
    }

    /// All cliques of the largest size, searching at most `budget` nodes.
    pub fn largest_cliques(&self, budget: usize) -> Cliques {
        let n = self.neighbours.len();
        let mut all = vec![0u64; n.div_ceil(64)];
        (0..n).for_each(|v| all[v / 64] |= 1 << (v % 64));
        let mut search = Search { graph: self, clique: Vec::new(), best: Vec::new(), size: 1, nodes: budget };
        search.extend(&all);
        let complete = search.nodes > 0;
        let mut cliques = search.best;
        cliques.iter_mut().for_each(|clique| clique.sort_unstable());
        cliques.sort();
        Cliques { cliques, complete }
    }
}

struct Search<'a> {
    graph: &'a Graph,
    clique: Vec<usize>,
    best: Vec<Vec<usize>>,
    /// Size of the best cliques.
    size: usize,
    /// Nodes left.
    nodes: usize,
}

impl Search<'_> {
    fn extend(&mut self, candidates: &[u64]) {
        if self.nodes == 0 {
            return;
        }
        self.nodes -= 1;
        let coloured = self.colour(candidates);
        if coloured.is_empty() {
            self.keep();
            return;
        }
        let mut left = candidates.to_vec();
        // Highest colour first: as soon as the bound fails it fails for all that follow.
        for &(vertex, colour) in coloured.iter().rev() {
            if self.clique.len() + colour < self.size {
                return;
            }
            let next: Vec<u64> = left.iter().zip(&self.graph.neighbours[vertex]).map(|(a, b)| a & b).collect();
            self.clique.push(vertex);
            self.extend(&next);
            self.clique.pop();
            left[vertex / 64] &= !(1 << (vertex % 64));
        }
    }

    fn keep(&mut self) {
        if self.clique.len() > self.size {
            self.size = self.clique.len();
            self.best.clear();
        }
        if self.clique.len() == self.size {
            self.best.push(self.clique.clone());
        }
    }

    /// Candidates with their colours from 1 on, in order of colour; vertices of one colour are not joined.
    fn colour(&self, candidates: &[u64]) -> Vec<(usize, usize)> {
        let mut uncoloured = candidates.to_vec();
        let mut out = Vec::new();
        let mut colour = 0;
        while uncoloured.iter().any(|&word| word != 0) {
            colour += 1;
            let mut free = uncoloured.clone();
            while let Some(vertex) = first(&free) {
                out.push((vertex, colour));
                let bit = 1 << (vertex % 64);
                free[vertex / 64] &= !bit;
                uncoloured[vertex / 64] &= !bit;
                for (word, neighbours) in free.iter_mut().zip(&self.graph.neighbours[vertex]) {
                    *word &= !neighbours;
                }
            }
        }
        out
    }
}

fn first(set: &[u64]) -> Option<usize> {
    set.iter().position(|&word| word != 0).map(|i| 64 * i + set[i].trailing_zeros() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(n: usize, edges: &[(usize, usize)]) -> Graph {
        let mut graph = Graph::new(n);
        edges.iter().for_each(|&(a, b)| graph.join(a, b));
        graph
    }

    #[test]
    fn finds_all_triangles_of_two_that_share_an_edge() {
        let graph = graph(5, &[(0, 1), (1, 2), (0, 2), (1, 3), (2, 3), (3, 4)]);
        let found = graph.largest_cliques(1000);
        assert_eq!(found, Cliques { cliques: vec![vec![0, 1, 2], vec![1, 2, 3]], complete: true });
    }

    #[test]
    fn agrees_with_trying_all_subsets() {
        let mut random = crate::robust::Random::stream(1, 0);
        for _ in 0..200 {
            let mut graph = Graph::new(11);
            let mut joined = std::collections::BTreeSet::new();
            for a in 0..11 {
                for b in 0..a {
                    if random.below(4) != 0 {
                        graph.join(a, b);
                        joined.extend([(a, b), (b, a)]);
                    }
                }
            }
            let mut best: Vec<Vec<usize>> = Vec::new();
            for subset in 1u32..1 << 11 {
                let members: Vec<usize> = (0..11).filter(|v| subset >> v & 1 == 1).collect();
                let clique = members.iter().all(|&a| members.iter().all(|&b| a == b || joined.contains(&(a, b))));
                let size = best.first().map_or(0, Vec::len);
                if clique && members.len() > size {
                    best.clear();
                }
                if clique && members.len() >= size {
                    best.push(members);
                }
            }
            best.sort();
            assert_eq!(graph.largest_cliques(1_000_000).cliques, best);
        }
    }

    #[test]
    fn vertices_beyond_the_first_word_count_and_a_spent_budget_is_told() {
        let edges: Vec<(usize, usize)> = (60..130).flat_map(|a| (60..a).map(move |b| (a, b))).collect();
        let found = graph(130, &edges).largest_cliques(10_000);
        assert_eq!(found.cliques, vec![(60..130).collect::<Vec<_>>()]);
        assert!(!graph(130, &edges).largest_cliques(3).complete);
        assert!(graph(0, &[]).largest_cliques(10).cliques.is_empty());
    }
}
