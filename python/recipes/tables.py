"""A sweep as pandas and polars tables, and as Parquet: the columns share memory with the arrays."""

import tempfile
from pathlib import Path

import hardpoint as hp

STUDY = Path(__file__).resolve().parents[2] / "studies" / "macpherson_sweep.toml"

if __name__ == "__main__":
    rows = hp.sweep(hp.load(STUDY, {"sweep.samples": 2000}))

    table = rows.to_pandas()
    best = table.nsmallest(5, "misfit")
    print(f"misfit of the best five of {len(table)}: {best['misfit'].round(3).tolist()}")
    print(table.corr(numeric_only=True)["misfit"].drop("misfit").abs().nlargest(3).round(2).to_string())

    try:
        import polars
    except ImportError:
        pass
    else:
        frame = polars.DataFrame(rows)  # through the Arrow stream of the sweep, without a copy
        assert frame["misfit"].min() == table["misfit"].min()
        print(frame.select(polars.col("^camber.*_deg$")).describe())

    try:
        import pyarrow  # noqa: F401
    except ImportError:
        pass
    else:
        with tempfile.TemporaryDirectory() as folder:
            rows.to_parquet(Path(folder) / "rows.parquet")
