"""What every measurement needs: clock, processes, what is kept, and where numbers come from."""
