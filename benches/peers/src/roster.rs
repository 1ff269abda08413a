//! All configurations, one a line.

use obvhs::BvhBuildParams as Preset;
use octogrid::{BuildOptions, Structure};

use crate::peer::Tracer;
use crate::peers::bvh::Bvh;
use crate::peers::embree::{self, Embree, Quality};
use crate::peers::obvhs::{Kind, Obvhs};
use crate::peers::octogrid::{Calls, Octogrid};
use crate::peers::parry;

/// What all others are compared with.
pub(crate) const BASELINE: &str = "embree-med";

/// A configuration by name.
pub(crate) struct Contender {
    /// The library, a hyphen, and what sets it apart from the library's others.
    pub(crate) name: &'static str,
    pub(crate) tracer: Box<dyn Tracer>,
    /// Whether it runs when nobody asks for it.
    pub(crate) usual: bool,
}

impl Contender {
    /// The library's name.
    pub(crate) fn library(&self) -> &'static str {
        self.name.split('-').next().unwrap_or(self.name)
    }
}

/// Everything that can be measured.
pub(crate) fn all() -> Vec<Contender> {
    let plan = BuildOptions::default();
    let fast = BuildOptions { quality: octogrid::Quality::Fast, ..plan };
    let with = |name, tracer, usual| Contender { name, tracer, usual };
    vec![
        with("octogrid", octogrid(plan, Calls::Single), true),
        with("octogrid-batch", octogrid(plan, Calls::Batch), true),
        with("octogrid-packet16", octogrid(plan, Calls::Packets16), true),
        with("octogrid-stream", octogrid(plan, Calls::Stream), true),
        with("octogrid-fast", octogrid(fast, Calls::Single), true),
        with("octogrid-fast-stream", octogrid(fast, Calls::Stream), true),
        with("octogrid-octree", octogrid(Structure::OCTREE.into(), Calls::Single), true),
        with("octogrid-uniform", octogrid(Structure::UNIFORM.into(), Calls::Single), false),
        with("octogrid-recursive", octogrid(Structure::RECURSIVE.into(), Calls::Single), false),
        with("embree-low", embree(Quality::Low, false, embree::Calls::Single), true),
        with("embree-med", embree(Quality::Medium, false, embree::Calls::Single), true),
        with("embree-high", embree(Quality::High, false, embree::Calls::Single), true),
        with("embree-med-robust", embree(Quality::Medium, true, embree::Calls::Single), true),
        with("embree-high-robust", embree(Quality::High, true, embree::Calls::Single), false),
        with("embree-med-packet8", embree(Quality::Medium, false, embree::Calls::Packets8), true),
        with("embree-med-packet16", embree(Quality::Medium, false, embree::Calls::Packets16), true),
        with("obvhs-cwbvh-fastest", obvhs(Kind::Wide, Preset::fastest_build), true),
        with("obvhs-cwbvh-very-fast", obvhs(Kind::Wide, Preset::very_fast_build), false),
        with("obvhs-cwbvh-fast", obvhs(Kind::Wide, Preset::fast_build), false),
        with("obvhs-cwbvh-medium", obvhs(Kind::Wide, Preset::medium_build), true),
        with("obvhs-cwbvh-slow", obvhs(Kind::Wide, Preset::slow_build), false),
        with("obvhs-cwbvh-very-slow", obvhs(Kind::Wide, Preset::very_slow_build), true),
        with("obvhs-bvh2-fastest", obvhs(Kind::Binary, Preset::fastest_build), false),
        with("obvhs-bvh2-medium", obvhs(Kind::Binary, Preset::medium_build), true),
        with("obvhs-bvh2-very-slow", obvhs(Kind::Binary, Preset::very_slow_build), false),
        with("bvh", Box::new(Bvh), true),
        with("parry3d-trimesh", Box::new(parry::Mesh), false),
        with("parry3d-bvh", Box::new(parry::Tree), true),
    ]
}

fn octogrid(options: BuildOptions, calls: Calls) -> Box<dyn Tracer> {
    Box::new(Octogrid { options, calls })
}

fn embree(quality: Quality, robust: bool, calls: embree::Calls) -> Box<dyn Tracer> {
    Box::new(Embree { quality, robust, calls })
}

fn obvhs(kind: Kind, preset: fn() -> Preset) -> Box<dyn Tracer> {
    Box::new(Obvhs { kind, preset })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load;
    use crate::measure::{self, Effort};

    /// Needs what `setup.sh` fetches.
    #[test]
    fn all_answer_alike() {
        let (loaded, contenders) = (load::load("torus").unwrap(), all());
        let measured = measure::scene(&loaded, &contenders, &Effort::least()).unwrap();
        for (contender, score) in contenders.iter().zip(&measured.scores) {
            for (trace, (set, rays, _)) in score.traces.iter().zip(&measured.sets) {
                // Triangles that are split are counted several times.
                let splits = contender.name.contains("high") || contender.name.contains("slow");
                let wrong = trace.as_ref().map_or(0, |trace| trace.wrong);
                let fine = if splits && *set == "all hits" { *rays } else { rays / 100 };
                assert!(wrong <= fine, "{}: {wrong} of {rays} {set}", contender.name);
                assert!(wrong == 0 || !contender.tracer.is_exact());
            }
        }
    }
}
