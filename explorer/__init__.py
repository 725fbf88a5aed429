"""The page: edit motion and gains in a browser and see, live, what one range can tell."""
