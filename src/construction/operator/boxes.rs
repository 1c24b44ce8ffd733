//! A tree of boxes over many children, to find those that a point or a tile can see.

use crate::construction::area::Area;

/// Children in a leaf.
const LEAF: usize = 4;

/// A binary tree of boxes; finds the children whose boxes meet a box.
#[derive(Clone, Debug)]
pub(in crate::construction) struct Boxes {
    areas: Vec<Area>,
    /// Children, in the order of the leaves.
    order: Vec<u32>,
    /// Box, first and end in `order`, and the index of the second half's node; 0 for a leaf.
    nodes: Vec<(Area, u32, u32, u32)>,
}

impl Boxes {
    /// The tree over the children's boxes.
    pub(in crate::construction) fn new(areas: Vec<Area>) -> Self {
        let mut order: Vec<u32> = (0..areas.len() as u32).collect();
        let mut nodes = vec![];
        if !areas.is_empty() {
            split(&areas, &mut order, 0, &mut nodes);
        }
        Self { areas, order, nodes }
    }

    /// Indices of the children whose boxes meet `area`, ascending, into `found`.
    pub(in crate::construction) fn meeting(&self, area: &Area, found: &mut Vec<u32>) {
        found.clear();
        if self.nodes.is_empty() {
            return;
        }
        let mut open = vec![0_u32];
        while let Some(at) = open.pop() {
            let (whole, from, end, second) = &self.nodes[at as usize];
            if !whole.meets(area) {
                continue;
            }
            if *second == 0 {
                let items = &self.order[*from as usize..*end as usize];
                found.extend(items.iter().filter(|&&i| self.areas[i as usize].meets(area)));
            } else {
                open.push(at + 1);
                open.push(*second);
            }
        }
        found.sort_unstable();
    }

    /// Bytes of memory.
    pub(in crate::construction) fn bytes(&self) -> usize {
        size_of_val(&self.areas[..]) + size_of_val(&self.order[..]) + size_of_val(&self.nodes[..])
    }
}

/// Adds the node over `order`, which begins at `from` in the whole, and all below it.
fn split(areas: &[Area], order: &mut [u32], from: u32, nodes: &mut Vec<(Area, u32, u32, u32)>) {
    let whole = order.iter().fold(Area::EMPTY, |all, &i| all.hull(&areas[i as usize]));
    let at = nodes.len();
    nodes.push((whole, from, from + order.len() as u32, 0));
    if order.len() <= LEAF {
        return;
    }
    // Twice the centre; children without bounds come in any fixed order.
    let middle = |i: u32, along_x: bool| {
        let range = if along_x { areas[i as usize].x } else { areas[i as usize].y };
        let sum = range.min + range.max;
        if sum.is_nan() { 0.0 } else { sum }
    };
    let along_x = whole.x.width() >= whole.y.width();
    order.sort_by(|&a, &b| middle(a, along_x).total_cmp(&middle(b, along_x)).then(a.cmp(&b)));
    let half = order.len() / 2;
    let (first, second) = order.split_at_mut(half);
    split(areas, first, from, nodes);
    nodes[at].3 = nodes.len() as u32;
    split(areas, second, from + half as u32, nodes);
}
