"""Height and depth of von Mises peaks against scales of the contact: is there one curve for all surfaces?"""
