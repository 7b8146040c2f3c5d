import sys

from dyncal_bridge.command import main

sys.exit(main())
