"""min-height as an agent in Python. Usage: min_height.py DOMAIN RUN WORKER NAME"""

import sys

from aloft.dds import Action, Agent


class MinHeight(Agent):
    stateless = True  # a report says all that it needs

    def act(self, report):
        return Action.ACTION_DOWN if report.height_m > report.height_min_m else Action.ACTION_HOLD


if __name__ == "__main__":
    MinHeight().run(int(sys.argv[1]), *sys.argv[2:])
