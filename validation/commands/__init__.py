"""The tippedisk: a rigid disk whose centre of gravity lies off its centre.

Spun fast about an in-plane axis on a table, it turns itself upside down through friction.

Models 1 to 4 each add a constraint: 1 the disk stays on the table, 2 its centre of gravity
stays above one point, 3 it does not slip along its edge, 4 its spin is constant; other sets of
constraints go as well. Each runs in the multibody engine Exudyn (--source engine) and in
independent in-house equations (--source in-house).

commands:
{commands}

examples:
  tippedisk report                                   everything, as two pages in ./report
  tippedisk simulate --model 1 --out engine.npz      the engine, from the paper's start
  tippedisk simulate --model 1 --source in-house --out equations.npz
  tippedisk show engine.npz equations.npz --plot compare.png
  tippedisk scenario > my.toml                       the whole problem as a file, to be changed
  tippedisk simulate --scenario my.toml --out mine.npz
  tippedisk check --scenario my.toml                 do engine and equations agree on it?
  tippedisk simulate --inclination 2deg --law tanh --gamma -pi/2+0.3 --out slope.npz
  tippedisk sweep spin=25:45:41 mu=0.1,0.3 --out inversion.db
  tippedisk map spin-friction                        who inverts, refined where it changes
  tippedisk eigenvalues --system full --spin 0:50:501 --csv six.csv --plot six.png
  tippedisk critical --system full                   where eigenvalues cross, where it is stable
  tippedisk rest --rolling 1e-3 --pivoting 5e-5 --plot rest.png
  tippedisk animate engine.npz                       a page that plays the motion
  tippedisk play                                     a page on which the disk is spun by hand

Each command has its own --help. Every switch has a --no-SWITCH; `-` is standard output, and where
a scenario or axes are read, standard input.

exit codes:
   0  done
   1  a check fails, or a run
   2  refused: one line says what is allowed
   3  done, all files are written, but standard output could not be written to
  70  a fault of this program, or of a module of your own
 130  interrupted

`python -m validation` is the same command.
"""  # noqa: D405, D406, D407 - its headings are those of the help
