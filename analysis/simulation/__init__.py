"""In-house simulation: equations of motion as initial value problems, of one run or of many."""
