//! Finds room for labels: the most important first, each at the best free position round its point.

use std::collections::HashMap;

/// A rectangle on the picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) width: f32,
    pub(super) height: f32,
}

impl Area {
    /// The square round a point.
    pub(super) fn around(x: f32, y: f32, radius: f32) -> Self {
        Self { x: x - radius, y: y - radius, width: 2.0 * radius, height: 2.0 * radius }
    }

    /// Whether two areas share more than an edge.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    fn holds(&self, other: &Self) -> bool {
        other.x >= self.x
            && other.y >= self.y
            && other.x + other.width <= self.x + self.width
            && other.y + other.height <= self.y + self.height
    }
}

/// On which side of its point a label stands; its lines are set towards the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// To the right.
    Right,
    /// To the left.
    Left,
    /// Above or below.
    Middle,
}

/// The room that was found for a label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) area: Area,
    pub(super) side: Side,
}

/// What is taken on a picture, by squares so that a question touches only what is near.
pub(super) struct Room {
    bounds: Area,
    taken: HashMap<(i32, i32), Vec<Area>>,
}

/// Side of the squares in pixels.
const SQUARE: f32 = 64.0;

impl Room {
    /// Free room within bounds.
    pub(super) fn new(bounds: Area) -> Self {
        Self { bounds, taken: HashMap::new() }
    }

    /// Whether an area lies within the bounds and overlaps nothing that is taken.
    pub(super) fn is_free(&self, area: &Area) -> bool {
        self.bounds.holds(area)
            && squares(area)
                .all(|square| self.taken.get(&square).is_none_or(|list| !list.iter().any(|other| other.overlaps(area))))
    }

    /// Takes an area, free or not.
    pub(super) fn take(&mut self, area: Area) {
        for square in squares(&area) {
            self.taken.entry(square).or_default().push(area);
        }
    }

    /// Finds room for a label of a size beside the point, `away` from it, and takes it.
    ///
    /// The positions are tried in the order of Imhof's preference: right and up first, straight below last.
    pub(super) fn beside(&mut self, (x, y): (f32, f32), away: f32, (width, height): (f32, f32)) -> Option<Spot> {
        // On the diagonals the label may come a little nearer.
        let near = away * 0.8;
        let positions = [
            (x + near, y - near - 0.6 * height, Side::Right),
            (x + away, y - 0.5 * height, Side::Right),
            (x + near, y + near - 0.4 * height, Side::Right),
            (x - near - width, y - near - 0.6 * height, Side::Left),
            (x - away - width, y - 0.5 * height, Side::Left),
            (x - near - width, y + near - 0.4 * height, Side::Left),
            (x - 0.5 * width, y - away - height, Side::Middle),
            (x - 0.5 * width, y + away, Side::Middle),
        ];
        let spot = positions
            .into_iter()
            .map(|(x, y, side)| Spot { area: Area { x, y, width, height }, side })
            .find(|spot| self.is_free(&spot.area))?;
        self.take(spot.area);
        Some(spot)
    }
}

fn squares(area: &Area) -> impl Iterator<Item = (i32, i32)> + use<> {
    let at = |v: f32| (v / SQUARE).floor() as i32;
    let (x0, x1) = (at(area.x), at(area.x + area.width));
    let (y0, y1) = (at(area.y), at(area.y + area.height));
    (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOUNDS: Area = Area { x: 0.0, y: 0.0, width: 400.0, height: 300.0 };

    proptest! {
        #[test]
        fn labels_never_overlap_and_stay_on_the_map(
            wishes in proptest::collection::vec((0.0_f32..400.0, 0.0_f32..300.0, 5.0_f32..90.0, 5.0_f32..30.0), 1..80),
        ) {
            let mut room = Room::new(BOUNDS);
            for &(x, y, _, _) in &wishes {
                room.take(Area::around(x, y, 3.0));
            }
            let spots: Vec<Area> = wishes
                .iter()
                .filter_map(|&(x, y, w, h)| room.beside((x, y), 5.0, (w, h)))
                .map(|spot| spot.area)
                .collect();
            for (i, spot) in spots.iter().enumerate() {
                prop_assert!(BOUNDS.holds(spot));
                prop_assert!(spots[..i].iter().all(|other| !other.overlaps(spot)));
                prop_assert!(wishes.iter().all(|w| !Area::around(w.0, w.1, 3.0).overlaps(spot)));
            }
        }
    }

    #[test]
    fn the_best_position_is_upper_right() {
        let mut room = Room::new(BOUNDS);
        let spot = room.beside((100.0, 100.0), 5.0, (40.0, 10.0)).unwrap();
        assert_eq!(spot.side, Side::Right);
        assert!(spot.area.x > 100.0 && spot.area.y + 5.0 < 100.0);
        let second = room.beside((100.0, 100.0), 5.0, (40.0, 10.0)).unwrap();
        assert!(second.area.y > spot.area.y, "the next one finds the next position");
    }

    #[test]
    fn a_label_in_the_corner_turns_inwards() {
        let mut room = Room::new(BOUNDS);
        assert_eq!(room.beside((395.0, 150.0), 5.0, (60.0, 10.0)).unwrap().side, Side::Left);
        assert_eq!(room.beside((200.0, 150.0), 5.0, (500.0, 10.0)), None);
    }
}
