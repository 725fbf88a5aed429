"""Studies: many runs over many presets, on one machine or a cluster, from a file; resumable, and equal to the last bit.

    study.load(FILE)                       the file, its base presets and its points
    plan.plan(study)                       points, runs, time and bytes
    running.run(study, STORE, workers=2)   computes what is missing in a store
    store.opened(STORE), export.to_csv     the results; xarray.open_zarr(STORE) reads them, too
    maps.coarse_to_fine(study)             a small map of two parameters, in this process

    study_file · parameters                what a person chooses
    metrics · estimators                   tables: a row for each
    evaluation · stopping                  one point, and when it has runs enough
    blocks · creation · receipts · store   the parts, and what of them is done
    tasks · cluster · running              dask
The extra `studies` is needed for stores and for dask: pip install "rangenav[studies]".
"""
