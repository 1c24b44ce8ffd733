//! How fast dictionaries are matched and learned, next to the bare product of matrices of the same size, and how good
//! they are; one line of JSON for each.

use orograph::dictionary::{
    Choice, Dictionary, Learning, NoiseFamily, PatchLayout, PatchShape, Patches, Pursuit, Raster, Samples,
    SparseTerrain, Storage, difference, learn, learn_constrained,
};
use orograph::watch::Watch;
use rayon::prelude::*;
use std::process::ExitCode;
use std::time::Instant;

const USAGE: &str = "usage: orograph-dictionary-speed WHAT RAW COLS ROWS ...
    RAW     elevations in metres, Float32, little-endian, row by row; NaN is a void
    WHAT    match SIDE STEP ATOMS SPARSITY REPS              patches matched with drawn atoms, and the bare product
            learn SIDE STEP ATOMS SPARSITY ITERATIONS        K-SVD
            constrain SIDE STEP ATOMS SPARSITY ITERATIONS    atoms that are patches
            quality SIDE STEP ATOMS SPARSITY ITERATIONS      PSNR of K-SVD's dictionary, and what it stores
            noise SIDE STEP ATOMS SPARSITY ITERATIONS CANDIDATES   PSNR of families of noise
            exact SIDE STEP                                  the complete dictionary";

type Any = Result<(), Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// What the command line asks for.
struct Job {
    cells: Vec<f32>,
    cols: usize,
    rows: usize,
    numbers: Vec<usize>,
}

impl Job {
    fn patches(&self) -> Result<Patches, Box<dyn std::error::Error>> {
        let [side, step, ..] = self.numbers[..] else { return Err(USAGE.into()) };
        let layout = PatchLayout::new(self.rows, self.cols, PatchShape::new(side)?, Some(step))?;
        Ok(Patches::new(&Raster::new(self.rows, self.cols, &self.cells)?, layout)?)
    }

    /// Atoms, sparsity, and the number after them.
    fn counts(&self) -> Result<(usize, usize, usize), Box<dyn std::error::Error>> {
        match self.numbers[..] {
            [_, _, atoms, sparsity, last, ..] => Ok((atoms, sparsity, last)),
            _ => Err(USAGE.into()),
        }
    }
}

fn run() -> Any {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, raw, cols, rows, numbers @ ..] = &arguments[..] else { return Err(USAGE.into()) };
    let cells: Vec<f32> = std::fs::read(raw)?.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let numbers = numbers.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
    let job = Job { cells, cols: cols.parse()?, rows: rows.parse()?, numbers };
    match what.as_str() {
        "match" => time_match(&job),
        "learn" => time_learn(&job, false),
        "constrain" => time_learn(&job, true),
        "quality" => quality(&job),
        "noise" => noise(&job),
        "exact" => exact(&job),
        _ => Err(USAGE.into()),
    }
}

fn time_match(job: &Job) -> Any {
    let (patches, (atoms, sparsity, reps)) = (job.patches()?, job.counts()?);
    let shape = patches.layout().shape();
    let dictionary = Samples::new(&patches, "bench").draw(atoms, 1)?;
    let threads = rayon::current_num_threads();
    for choice in [Choice::SmallestResidual, Choice::LargestCorrelation] {
        let (mut product_s, mut match_s) = (vec![], vec![]);
        for _ in 0..reps {
            product_s.push(bare_product(patches.len(), shape.values(), dictionary.values()));
            let begun = Moment::now();
            let found = Pursuit::new(&dictionary, sparsity, choice)?.decompose(&patches)?;
            match_s.push(begun.seconds());
            if found.codes.len() != patches.len() {
                return Err("patches were lost".into());
            }
        }
        let (product_s, match_s) = (median(product_s), median(match_s));
        let (clock, cpu) = (product_s.0 / match_s.0, product_s.1 / match_s.1);
        println!(
            "{{\"what\": \"match\", \"choice\": \"{choice:?}\", \"threads\": {threads}, \"patches\": {}, \"values\": {}, \
             \"atoms\": {atoms}, \"sparsity\": {sparsity}, \"product_s\": {:.4}, \"match_s\": {:.4}, \"share\": {clock:.3}, \
             \"product_cpu_s\": {:.4}, \"match_cpu_s\": {:.4}, \"share_of_cpu\": {cpu:.3}}}",
            patches.len(),
            shape.values(),
            product_s.0,
            match_s.0,
            product_s.1,
            match_s.1,
        );
    }
    Ok(())
}

/// Seconds of the product of as many patches with the atoms, on all threads, each with an equal part of the patches.
fn bare_product(rows: usize, inner: usize, atoms: &[f32]) -> (f64, f64) {
    let cols = atoms.len() / inner;
    let patches: Vec<f32> = (0..rows * inner).map(|i| (i % 101) as f32 - 50.0).collect();
    // Written before, so that the first touch of the memory is not timed.
    let mut scores = vec![1.0f32; rows * cols];
    let part = rows.div_ceil(rayon::current_num_threads());
    let begun = Moment::now();
    scores.par_chunks_mut(part * cols).zip(patches.par_chunks(part * inner)).for_each(|(scores, patches)| {
        let (rows, stride) = (patches.len() / inner, inner as isize);
        assert_eq!(scores.len(), rows * cols, "whole rows");
        // SAFETY: lengths fit the strides, as the line above and the chunks have it.
        unsafe {
            let (a, b, out) = (patches.as_ptr(), atoms.as_ptr(), scores.as_mut_ptr());
            matrixmultiply::sgemm(rows, inner, cols, 1.0, a, stride, 1, b, 1, stride, 0.0, out, cols as isize, 1);
        }
    });
    let seconds = begun.seconds();
    std::hint::black_box(&scores);
    seconds
}

fn learning(sparsity: usize, iterations: usize) -> Learning {
    Learning { iterations, sparsity, choice: Choice::SmallestResidual }
}

fn time_learn(job: &Job, constrained: bool) -> Any {
    let (patches, (atoms, sparsity, iterations)) = (job.patches()?, job.counts()?);
    let samples = Samples::new(&patches, "bench");
    let product_s = bare_product(samples.len(), samples.shape().values(), samples.draw(atoms, 1)?.values());
    let how = learning(sparsity, iterations);
    let begun = Moment::now();
    let learned = if constrained {
        let candidates = samples.clone().into_dictionary();
        learn_constrained(&samples, &candidates, (atoms, 1), &how, &Watch::default())?
    } else {
        learn(&samples, samples.draw(atoms, 1)?, &how, &Watch::default())?
    };
    let learn_s = begun.seconds();
    println!(
        "{{\"what\": \"{}\", \"threads\": {}, \"patches\": {}, \"values\": {}, \"atoms\": {atoms}, \"sparsity\": {sparsity}, \
         \"iterations\": {iterations}, \"product_s\": {:.4}, \"product_cpu_s\": {:.4}, \"learn_s\": {:.3}, \
         \"learn_cpu_s\": {:.3}, \"error_m2\": {:?}}}",
        if constrained { "constrain" } else { "learn" },
        rayon::current_num_threads(),
        samples.len(),
        samples.shape().values(),
        product_s.0,
        product_s.1,
        learn_s.0,
        learn_s.1,
        learned.error_m2,
    );
    Ok(())
}

/// Matches, rebuilds, compares and prints.
fn report(job: &Job, what: &str, patches: &Patches, dictionary: Dictionary, sparsity: usize) -> Any {
    let storage = Storage::new(patches.layout(), dictionary.len(), sparsity);
    let found = Pursuit::new(&dictionary, sparsity, Choice::SmallestResidual)?.decompose(patches)?;
    let coefficients = found.codes.coefficients();
    let rebuilt = SparseTerrain::of(patches, &found, dictionary)?.raster(1)?;
    let difference = difference(&job.cells, &rebuilt).ok_or("nothing to compare")?;
    println!(
        "{{\"what\": \"{what}\", \"side\": {}, \"step\": {}, \"patches\": {}, \"atoms\": {}, \"sparsity\": {sparsity}, \
         \"coefficients\": {coefficients}, \"psnr_db\": {:.2}, \"rms_m\": {:.5}, \"max_m\": {:.4}, \
         \"ratio_as_counted\": {:.4}, \"ratio_as_printed\": {:.4}}}",
        patches.layout().shape().side(),
        patches.layout().step(),
        storage.patches,
        storage.atoms,
        difference.psnr_db,
        difference.rms_m,
        difference.max_m,
        storage.ratio_as_counted(),
        storage.ratio_as_printed(),
    );
    Ok(())
}

fn quality(job: &Job) -> Any {
    let (patches, (atoms, sparsity, iterations)) = (job.patches()?, job.counts()?);
    let samples = Samples::new(&patches, "bench");
    let start = samples.draw(atoms, 1)?;
    let learned = learn(&samples, start, &learning(sparsity, iterations), &Watch::default())?;
    report(job, "quality", &patches, learned.dictionary, sparsity)
}

fn noise(job: &Job) -> Any {
    let (patches, (atoms, sparsity, iterations)) = (job.patches()?, job.counts()?);
    let candidates = *job.numbers.get(5).ok_or(USAGE)?;
    let samples = Samples::new(&patches, "bench");
    for family in [NoiseFamily::Perlin, NoiseFamily::Ridged, NoiseFamily::RidgedMultifractal] {
        let all = Dictionary::noise(family, samples.shape(), candidates, 1)?;
        report(job, &format!("{family:?}, all"), &patches, all.clone(), sparsity)?;
        let how = learning(sparsity, iterations);
        let learned = learn_constrained(&samples, &all, (atoms, 1), &how, &Watch::default())?;
        report(job, &format!("{family:?}, chosen"), &patches, learned.dictionary, sparsity)?;
    }
    Ok(())
}

fn exact(job: &Job) -> Any {
    let patches = job.patches()?;
    report(job, "exact", &patches, Dictionary::complete(&patches, "bench"), 1)
}

/// A moment by the clock, and by what all threads of this process have had of processors, which other work on the
/// machine does not change as much.
struct Moment(Instant, f64);

impl Moment {
    fn now() -> Self {
        Self(Instant::now(), processor_s())
    }

    /// Seconds since then by both; without the second where the system does not tell it.
    fn seconds(&self) -> (f64, f64) {
        (self.0.elapsed().as_secs_f64(), processor_s() - self.1)
    }
}

/// Processor seconds of all threads.
fn processor_s() -> f64 {
    // Linux brings a thread's account up to date when it yields, otherwise only at its next tick.
    rayon::broadcast(|_| std::thread::yield_now());
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let of = |task: std::fs::DirEntry| {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    };
    tasks.filter_map(of).sum::<f64>() / 1e9
}

/// The medians of both.
fn median(values: Vec<(f64, f64)>) -> (f64, f64) {
    let (clock, cpu): (Vec<f64>, Vec<f64>) = values.into_iter().unzip();
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        (values[(values.len() - 1) / 2] + values[values.len() / 2]) / 2.0
    };
    (middle(clock), middle(cpu))
}
