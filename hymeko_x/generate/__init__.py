"""A language model converts a robot; its answers are checked and verified, and the next prompt lists what to repair. Figure 6 of the paper.

Source: Hajdu and Hegyi, Appl. Mech. 2025, 6(4), 74, sections 4 and 5.3.
"""
