"""Files of other tools as orbit and attitude histories; every convention is declared where it is applied."""
