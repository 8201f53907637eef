"""Tests that take half a minute and more are marked `long` and run by `pytest -m long` (`scripts/test-long.sh`) only."""


def pytest_configure(config):
    config.addinivalue_line("markers", "long: takes half a minute or more; left out unless -m asks for it")
    if not config.option.markexpr:
        config.option.markexpr = "not long"
