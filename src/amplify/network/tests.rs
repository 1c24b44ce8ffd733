//! Slow and plain versions of what networks do, in double precision; and what has to hold of all of them.

use super::super::bicubic::{Bicubic, MARGIN};
use super::super::extend::{extended, extended_mask};
use super::super::orientation::Way;
use super::super::plane::Plane;
use super::convolution::Convolution;
use super::field::Field;
use super::{NETWORK_REACH, Network, REACH, RISES, rises};
use crate::rng::Rng;
use proptest::prelude::*;

fn drawn(values: &mut [f32], rng: &mut Rng) {
    values.iter_mut().for_each(|value| *value = rng.between(-1.0, 1.0) as f32);
}

fn field(rows: usize, cols: usize, depth: usize, rng: &mut Rng) -> Field {
    let mut field = Field::zeros(rows, cols, depth);
    drawn(&mut field.values, rng);
    field
}

/// A layer whose numbers that fill up octets have no weight.
fn layer(inputs: usize, outputs: usize, rng: &mut Rng) -> Convolution {
    let mut layer = Convolution::new(inputs, outputs);
    let depth = layer.depth();
    layer.weights.chunks_exact_mut(depth).for_each(|parts| drawn(&mut parts[..outputs], rng));
    layer
}

/// A network that nobody has taught.
fn network(factor: usize, is_square: bool, rng: &mut Rng) -> Network {
    let mut network = Network::new(factor, is_square);
    for own in &mut network.layers {
        *own = layer(own.inputs, own.outputs, rng);
    }
    network
}

/// A number of a cell that comes out, by definition.
fn slowly(layer: &Convolution, field: &Field, row: usize, col: usize, output: usize) -> f64 {
    let mut sum = 0.0;
    for (r, c) in (0..9).map(|cell| (cell / 3, cell % 3)) {
        for input in 0..layer.inputs {
            let weight = layer.weights[((r * 3 + c) * layer.inputs + input) * layer.depth() + output];
            sum += f64::from(weight) * f64::from(field.row(row + r)[(col + c) * field.depth + input]);
        }
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn layers_are_what_they_are_defined_to_be(
        inputs in 1usize..30,
        outputs in 1usize..50,
        rows in 3usize..6,
        cols in 3usize..12,
        seed: u64,
    ) {
        let rng = &mut Rng::new(seed);
        let layer = layer(inputs, outputs, rng);
        let before = field(rows, cols, inputs, rng);
        let [plain, rectified] = [false, true].map(|rectified| layer.field(&before, rectified));
        prop_assert_eq!((plain.rows, plain.cols, plain.depth), (rows - 2, cols - 2, outputs.next_multiple_of(8)));
        for row in 0..plain.rows {
            for (i, (&a, &b)) in plain.row(row).iter().zip(rectified.row(row)).enumerate() {
                let known = slowly(&layer, &before, row, i / plain.depth, i % plain.depth);
                prop_assert!((f64::from(a) - known).abs() < 1e-4, "{} and {}", a, known);
                prop_assert_eq!(b, a.max(0.0));
            }
        }

        // The sum of what comes out, each times some number, rises with each weight and each number that goes in as the
        // derivatives say: it is linear in both.
        let mut slopes = Field::zeros(rows - 2, cols - 2, layer.depth());
        slopes.values.chunks_exact_mut(layer.depth()).for_each(|cell| drawn(&mut cell[..outputs], rng));
        let sum = |layer: &Convolution, field: &Field| -> f64 {
            let cells = (0..rows - 2).flat_map(|row| (0..cols - 2).map(move |col| (row, col)));
            let part = |(row, col): (usize, usize), output: usize| {
                f64::from(slopes.row(row)[col * layer.depth() + output]) * slowly(layer, field, row, col, output)
            };
            cells.flat_map(|cell| (0..outputs).map(move |output| part(cell, output))).sum()
        };
        let found = layer.weight_slopes(&before, &slopes);
        let turned = layer.turned().field(&slopes.widened(2), false);
        for _ in 0..10 {
            let at = rng.below((9 * inputs * outputs) as u64) as usize;
            let at = at / outputs * layer.depth() + at % outputs;
            let mut other = layer.clone();
            other.weights[at] += 1.0;
            let rise = sum(&other, &before) - sum(&layer, &before);
            prop_assert!((rise - f64::from(found[at])).abs() < 1e-3, "{} and {}", rise, found[at]);
            let (cell, input) = (rng.below((rows * cols) as u64) as usize, rng.below(inputs as u64) as usize);
            let mut other = before.clone();
            other.values[cell * inputs + input] += 1.0;
            let rise = sum(&layer, &other) - sum(&layer, &before);
            let slope = turned.values[cell * turned.depth + input];
            prop_assert!((rise - f64::from(slope)).abs() < 1e-3, "{} and {}", rise, slope);
        }
    }
}

/// Waves and noise.
fn hills(rows: usize, cols: usize, rng: &mut Rng) -> Plane {
    let height = |cell: usize| 20.0 * ((cell / cols) as f64 * 0.3).sin() * ((cell % cols) as f64 * 0.2).cos();
    Plane::new(rows, cols, (0..rows * cols).map(|cell| height(cell) + 5.0 * rng.unit()).collect())
}

/// All of a plane, with margins.
fn whole(plane: &Plane) -> (Plane, Vec<bool>) {
    let size = [plane.rows(), plane.cols()];
    let margin = NETWORK_REACH as i64;
    let wanted = [-margin, -margin, size[0] as i64 + 2 * margin, size[1] as i64 + 2 * margin];
    let known = vec![true; size[0] * size[1]];
    (extended(plane, [0, 0], size, wanted), extended_mask(&known, size[1], [0, 0], size, wanted))
}

#[test]
fn rows_one_after_the_other_are_the_field() {
    let rng = &mut Rng::new(7);
    for factor in [2, 3, 4, 5, 7] {
        let network = network(factor, true, rng);
        let plane = hills(2 * REACH + 3, 2 * REACH + 9, rng);
        let mut input = Field::zeros(plane.rows() - 2, plane.cols() - 2, RISES);
        for row in 0..input.rows {
            rises([plane.row(row + 1), plane.row(row + 2)].map(|row| &row[1..]), input.row_mut(row));
        }
        let (known, before) = network.traced(input);
        assert_eq!((known.rows, known.cols, before.len()), (3, 9, 5));
        let mut count = 0;
        network.details(&plane, |row, details| {
            assert_eq!(details, known.row(row), "factor {factor}, row {row}");
            count += 1;
        });
        assert_eq!(count, 3);
    }
}

#[test]
fn slopes_of_all_layers_are_those_of_the_error() {
    let rng = &mut Rng::new(9);
    let mut network = network(2, true, rng);
    let input = field(13, 14, RISES, rng);
    let truth = field(3, 4, network.depth(), rng);
    let error = |network: &Network| -> f64 {
        let (out, _) = network.traced(input.clone());
        let half = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).powi(2) / 2.0;
        out.values.iter().zip(&truth.values).map(half).sum()
    };
    let (mut slopes, before) = network.traced(input.clone());
    slopes.values.iter_mut().zip(&truth.values).for_each(|(slope, truth)| *slope -= truth);
    let found = network.weight_slopes(&before, slopes);
    assert_eq!(found.len(), network.len());
    let most = found.iter().fold(0.0f32, |most, v| most.max(v.abs()));
    let mut seen = 0;
    for at in (0..network.len()).step_by(network.len() / 60) {
        let old = *network.weights_mut().nth(at).unwrap();
        let mut moved = |by: f32| {
            *network.weights_mut().nth(at).unwrap() = old + by;
            let error = error(&network);
            *network.weights_mut().nth(at).unwrap() = old;
            error
        };
        let rise = (moved(0.004) - moved(-0.004)) / 0.008;
        // What changes the sign of a number between two layers bends the error a little.
        assert!((rise - f64::from(found[at])).abs() < 0.02 * f64::from(most), "{at}: {rise} and {}", found[at]);
        seen += usize::from(found[at] != 0.0);
    }
    assert!(seen > 30, "{seen} weights matter");
}

#[test]
fn turned_and_steeper_terrain_is_no_other_case() {
    let rng = &mut Rng::new(3);
    for is_square in [true, false] {
        let network = network(3, is_square, rng);
        let (plane, _) = whole(&hills(11, 8, rng));
        let known = network.estimated(&plane, 1.0);
        let most = known.heights_m().iter().fold(0.0f64, |most, v| most.max(v.abs()));
        for way in Way::four(is_square) {
            let turned = network.estimated(&way.turned(&plane), 1.0);
            for (a, b) in way.turned(&known).heights_m().iter().zip(turned.heights_m()) {
                assert!((a - b).abs() < 1e-5 * most, "{way:?}: {a} and {b}");
            }
        }
        let four =
            |plane: &Plane| Plane::new(plane.rows(), plane.cols(), plane.heights_m().iter().map(|h| 4.0 * h).collect());
        assert_eq!(network.estimated(&four(&plane), 1.0), four(&known));
        let level = Plane::new(40, 40, vec![17.25; 1600]);
        assert_eq!(network.estimated(&level, 1.0), Bicubic::new(3).enlarged(&level).trimmed((REACH - MARGIN) * 3));
    }
}
