"""Shear thinning from Python: the viscosity of discs at three shear rates, each from runs in processes of their own."""

import argparse

import tether as tt

discs = {
    "box": {"size": [10.0, 10.0]},
    "fluid": {"temperature": 1.0},
    "bodies": [{"shape": "square", "volume_fraction": 0.3289}],
    "flow": {"kind": "couette", "shear_rate": 0.2},
    "run": {"timestep": 0.005, "equilibration": 2000, "strain": 40.0},
}

if __name__ == "__main__":  # the processes read this file too, and must not begin a study of their own
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--strain", type=float, default=40.0, help="strain that each rate is measured over")
    parser.add_argument("--out", default="thinning", help="folder of the runs; what is done there is not done again")
    asked = parser.parse_args()

    study = tt.Study(
        base=discs, set={"run.strain": asked.strain}, sweep={"flow.shear_rate": [0.2, 1.0, 5.0]}, repeats=2
    )
    results = tt.run_study(study, asked.out)
    for _, row in results.means.iterrows():
        viscosity, error = row["viscosity"], row["viscosity_error"]
        print(
            f"shear rate {row['shear_rate']:4.1f}   viscosity {viscosity:.3f} +- {error:.3f}   Pe {row['peclet']:.3g}"
        )
