"""Results that come with the package, one file for each section; see `validation.kit.shipped`."""
