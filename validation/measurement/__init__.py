"""What every measurement needs: its clock, its processes, and where its numbers come from."""
