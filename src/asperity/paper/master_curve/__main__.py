import sys
from asperity.config.study import read_study
from asperity.paper.master_curve.samples import collect

collect(read_study(sys.argv[1:]))
