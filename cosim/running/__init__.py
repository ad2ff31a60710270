"""One run: asked for, put together, rehearsed, simulated and analysed."""
