"""Pictures of robots: :mod:`hymeko_x.draw.render` draws the robot itself, without a screen."""
