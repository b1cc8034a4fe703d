"""In the folder that run.sh made: what its data sets hold."""
import glob
import json

import h5py
import numpy as np
import xarray
import zarr

file, group = h5py.File("sets/fall.h5"), zarr.open("sets/fall.zarr", "r")
frames = sorted(glob.glob("csv/*.csv"))
assert len(frames) == 15 == len(file["time"]) and len(set(file["count"][:])) > 3, "frames differ in their number of particles"
for k, name in enumerate(frames):
    rows = np.loadtxt(name, delimiter=",", skiprows=1, usecols=range(8))
    rows, n = rows[np.argsort(rows[:, 0])], len(rows)
    for data in (file, group):
        assert data["count"][k] == n and (data["id"][k, :n] == rows[:, 0]).all()
        assert (data["position"][k, :n] == rows[:, 1:4].astype(np.float32)).all() and (data["velocity"][k, :n] == rows[:, 4:7].astype(np.float32)).all()
        assert np.allclose(data["relative_density"][k, :n], rows[:, 7] / 1000, rtol=1e-6)
        assert np.isnan(data["position"][k, n:]).all() and np.isnan(data["velocity"][k, n:]).all() and (data["id"][k, n:] == 2**32 - 1).all()
assert file["position"].chunks[0] == 1 and file["position"].compression == "gzip" and group["position"].chunks[0] == 1

one, other = xarray.open_dataset("sets/fall.h5"), xarray.open_zarr("sets/fall.zarr")  # the latter warns where there is no consolidated metadata
xarray.testing.assert_equal(one.load(), other.load())
for data in (one, other):
    assert data.position.dims == ("time", "particle", "xyz") and list(data.xyz.values) == ["x", "y", "z"]
    units = {name: data[name].attrs["units"] for name in data.data_vars} | {"time": data.time.attrs["units"]}
    assert units == {"time": "s", "count": "1", "position": "m", "velocity": "m s-1", "relative_density": "1", "id": "1"}, units
    assert all(data[name].attrs["long_name"] for name in units)
    assert np.isclose(data.attrs["fluid.viscosity"], 2e-6) and list(data.attrs["fluid.gravity"]) == [0, -9.81, 0] and data.attrs["fluid.method"] == "pbf"
    assert data.attrs["emitters[0].speed"] == 1 and data.attrs["fluid.limits"] == 1 and data.attrs["fluid.box.periodicX"] == 0
    assert json.loads(data.attrs["scene"])["fluid"]["viscosity"] == 2e-6 and data.attrs["Conventions"].startswith("CF-")
    assert data.attrs["source"].startswith("Rivulet ") and " on cpu: " in data.attrs["simulated_by"] and data.attrs["recording"] == "fall.rrec"
    assert not any("[]" in name for name in data.attrs), "an item of an empty list is no parameter of the scene"

# Free fall: every particle's path is g t^2 / 2, but for the step of a method of first order.
column = xarray.open_dataset("scene/column.h5")
t = column.time.values
assert np.allclose(t, np.arange(1, 16) / 60)
y = column.position.sel(xyz="y").mean("particle").values
start = 0.7
assert np.allclose(start - y, 0.5 * 9.81 * t**2, atol=0.012), start - y
assert np.allclose(column.velocity.sel(xyz="y").mean("particle"), -9.81 * t, rtol=0.01)
xarray.testing.assert_equal(column.load(), xarray.open_zarr("scene/column.zarr").load())
third = h5py.File("sets/column.h5")
assert (third["time"][:] == t[::3]).all() and (third["position"][:] == h5py.File("scene/column.h5")["position"][::3]).all(), "a run recorded is that exported"

library = xarray.open_dataset("sets/library.h5")
assert np.isclose(library.attrs["fluid.viscosity"], 4e-6) and np.isclose(library.attrs["fluid.spacing"], 0.04) and library.attrs["emitters[0].speed"] == 1.5
assert library.attrs["source"].split()[1] in library.attrs["simulated_by"] and " on cpu: " in library.attrs["simulated_by"], library.attrs["simulated_by"]

foam = xarray.open_zarr("sets/foam.zarr")
assert foam.foam_count.max() > 10 and foam.foam_position.dims == ("time", "foam", "xyz")
kinds, sizes = foam.foam_kind.values, foam.foam_size.values
there = np.isfinite(sizes)
assert (there.sum(axis=1) == foam.foam_count.values).all() and np.isin(kinds[there], (1, 2, 3)).all() and (sizes[there] >= 0.5).all() and (sizes[there] <= 1).all()
