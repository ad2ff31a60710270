"""Where pedestrians will be: one file per predictor, and the models of walking behind them."""
