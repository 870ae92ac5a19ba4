"""The tippedisk built from Exudyn's own bodies, markers, joints and constraints."""
