"""Pedestrian test protocols; ``judging`` has ``names``, ``cases(name)`` and ``judge(run_folder, case)``."""
