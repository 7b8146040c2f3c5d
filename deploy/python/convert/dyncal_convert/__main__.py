import sys

from dyncal_convert.command import main

sys.exit(main())
