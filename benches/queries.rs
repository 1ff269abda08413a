//! Wall time of builds and queries: `cargo bench --bench queries`.

mod cases;

use cases::{Case, QUERIES, SCENES, run};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use octogrid::{BuildOptions, Scene, Structure};
use std::time::Duration;

fn builds(c: &mut Criterion) {
    for name in SCENES {
        let case = Case::new(name, 2048);
        let mesh = case.model.mesh().expect("a sound mesh");
        let mut group = c.benchmark_group(format!("build/{name}"));
        group.throughput(Throughput::Elements(mesh.len() as u64)).sample_size(10);
        for structure in Structure::ALL {
            let options = BuildOptions { structure: Some(structure), ..Default::default() };
            case.scene(structure);
            group.bench_function(structure.name(), |b| b.iter(|| Scene::build(&mesh, &options)));
        }
    }
}

fn queries(c: &mut Criterion) {
    for name in SCENES {
        let case = Case::new(name, 8192);
        for structure in Structure::ALL {
            let scene = case.scene(structure);
            let mut group = c.benchmark_group(format!("query/{name}"));
            group.throughput(Throughput::Elements(case.rays.len() as u64));
            for (query_name, query) in QUERIES {
                let id = BenchmarkId::new(structure.name(), query_name);
                group.bench_function(id, |b| b.iter(|| run(&scene, query, &case.rays)));
            }
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .sample_size(20);
    targets = builds, queries
}
criterion_main!(benches);
