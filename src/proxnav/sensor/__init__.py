"""From radiance to digital numbers, as a flight camera reads them."""
